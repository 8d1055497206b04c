include(GoogleTest)

# flies_add_module(<name>
#   COMPONENT c                 the installed library that the module is part of; without: a library for the program alone
#   SOURCES ... HEADERS ...     files of src/flies/<name>
#   PUBLIC_HEADERS ...          those of the headers that are the library's interface (docs/library.md); headers that they
#                               include are found and installed with them. Sub-folders keep their path
#   DEPENDS ...                 modules above this one
#   LINK_PUBLIC ... LINK_PRIVATE ...
#   TESTS ... TEST_LINK ...     unit tests of the module, one executable flies_<name>_test
#   )
# Makes the target flies_<name>.
function(flies_add_module name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "COMPONENT"
    "SOURCES;HEADERS;PUBLIC_HEADERS;DEPENDS;LINK_PUBLIC;LINK_PRIVATE;TESTS;TEST_LINK")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "flies_add_module(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  set(target flies_${name})
  if(ARG_COMPONENT)
    add_library(${target} INTERFACE)
    flies_add_to_component(${ARG_COMPONENT} ${name} SOURCES ${ARG_SOURCES} ${ARG_HEADERS}
      PUBLIC_HEADERS ${ARG_PUBLIC_HEADERS} LINK ${ARG_LINK_PUBLIC} ${ARG_LINK_PRIVATE})
    target_link_libraries(${target} INTERFACE ${ARG_LINK_PUBLIC})
  else()
    add_library(${target} STATIC ${ARG_SOURCES} ${ARG_HEADERS})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR}/src ${PROJECT_BINARY_DIR}/include)
    target_compile_features(${target} PUBLIC cxx_std_20)
    list(TRANSFORM ARG_DEPENDS PREPEND flies_ OUTPUT_VARIABLE depends)
    target_link_libraries(${target} PUBLIC ${depends} ${ARG_LINK_PUBLIC} PRIVATE ${ARG_LINK_PRIVATE})
    flies_set_warnings(${target})
  endif()
  set_property(GLOBAL APPEND PROPERTY FLIES_MODULES ${target})

  if(FLIES_BUILD_TESTS AND ARG_TESTS)
    flies_add_test(${target}_test SOURCES ${ARG_TESTS} LINK ${target} ${ARG_TEST_LINK})
  endif()
endfunction()

# flies_add_to_component(<component> <module> SOURCES ... PUBLIC_HEADERS ... LINK ...): a part of the module goes into
# this component. Called on its own for what a module has beside its main part, for who needs other libraries as well.
function(flies_add_to_component component module)
  cmake_parse_arguments(PARSE_ARGV 2 ARG "" "" "SOURCES;PUBLIC_HEADERS;LINK")
  set(objects flies_${module}_in_${component})
  add_library(${objects} OBJECT ${ARG_SOURCES} ${ARG_PUBLIC_HEADERS})
  set_target_properties(${objects} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${objects} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_BINARY_DIR}/include)
  target_link_libraries(${objects} PRIVATE ${ARG_LINK})
  flies_set_warnings(${objects})
  target_link_libraries(flies_${module} INTERFACE flies_component_${component})
  set_property(GLOBAL APPEND PROPERTY FLIES_OBJECTS_${component} $<TARGET_OBJECTS:${objects}>)
  set_property(GLOBAL APPEND PROPERTY FLIES_LINK_${component} ${ARG_LINK})
  list(TRANSFORM ARG_PUBLIC_HEADERS PREPEND flies/${module}/)
  set_property(GLOBAL APPEND PROPERTY FLIES_PUBLIC_HEADERS_${component} ${ARG_PUBLIC_HEADERS})
endfunction()

# flies_add_component(<name> LIBRARY <file name> DEPENDS <components> PUBLIC_HEADERS <below src>): the library
# flies::<name> of all that was added to it, with its headers and its description for CMake.
function(flies_add_component name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "LIBRARY" "DEPENDS;PUBLIC_HEADERS")
  set(target flies_component_${name})
  get_property(objects GLOBAL PROPERTY FLIES_OBJECTS_${name})
  get_property(links GLOBAL PROPERTY FLIES_LINK_${name})
  get_property(headers GLOBAL PROPERTY FLIES_PUBLIC_HEADERS_${name})
  list(REMOVE_DUPLICATES links)
  add_library(${target} ${objects})
  add_library(flies::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} OUTPUT_NAME ${ARG_LIBRARY} LINKER_LANGUAGE CXX
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_include_directories(${target} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} INTERFACE cxx_std_20)
  list(TRANSFORM ARG_DEPENDS PREPEND flies_component_ OUTPUT_VARIABLE depends)
  target_link_libraries(${target} PUBLIC ${depends} PRIVATE ${links})
  install(TARGETS ${target} EXPORT flies-${name}-targets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(EXPORT flies-${name}-targets NAMESPACE flies:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/flies
    COMPONENT development)
  flies_install_headers(${headers} ${ARG_PUBLIC_HEADERS})
endfunction()

# flies_install_headers(<headers below src>): these and all of ours that they include.
function(flies_install_headers)
  set(waiting ${ARGN})
  set(found)
  while(waiting)
    list(POP_FRONT waiting header)
    if(header IN_LIST found)
      continue()
    endif()
    list(APPEND found ${header})
    set(file ${PROJECT_SOURCE_DIR}/src/${header})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(STRINGS ${file} includes REGEX "^#include \"flies/")
    list(TRANSFORM includes REPLACE "^#include \"(flies/[^\"]+)\".*" "\\1")
    list(FILTER includes EXCLUDE REGEX "^flies/version.hpp$")
    list(APPEND waiting ${includes})
  endwhile()
  foreach(header IN LISTS found)
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${PROJECT_SOURCE_DIR}/src/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder}
      COMPONENT development)
  endforeach()
endfunction()

# flies_add_test(<name> SOURCES ... LINK ...): a GoogleTest executable whose cases are found when it is built.
function(flies_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;LINK")
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gmock_main)
  flies_set_warnings(${name})
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
    PROPERTIES ENVIRONMENT "FLIES_SOURCE_DIR=${PROJECT_SOURCE_DIR}" TIMEOUT 600)
endfunction()
