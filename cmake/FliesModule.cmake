include(GoogleTest)

# flies_add_module(<name>
#   SOURCES ... HEADERS ...     files of src/flies/<name>; headers in sub-folders keep their path when installed
#   DEPENDS ...                 modules above this one
#   LINK_PUBLIC ... LINK_PRIVATE ...
#   TESTS ... TEST_LINK ...     unit tests of the module, one executable flies_<name>_test
#   )
# Makes the static library flies_<name>, exported as flies::<name>.
function(flies_add_module name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;HEADERS;DEPENDS;LINK_PUBLIC;LINK_PRIVATE;TESTS;TEST_LINK")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "flies_add_module(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  set(target flies_${name})
  add_library(${target} STATIC ${ARG_SOURCES} ${ARG_HEADERS})
  add_library(flies::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  list(TRANSFORM ARG_DEPENDS PREPEND flies_ OUTPUT_VARIABLE depends)
  target_link_libraries(${target} PUBLIC ${depends} ${ARG_LINK_PUBLIC} PRIVATE ${ARG_LINK_PRIVATE})
  flies_set_warnings(${target})

  install(TARGETS ${target} EXPORT flies-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  foreach(header IN LISTS ARG_HEADERS)
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/flies/${name}/${folder})
  endforeach()
  set_property(GLOBAL APPEND PROPERTY FLIES_MODULES ${name})

  if(FLIES_BUILD_TESTS AND ARG_TESTS)
    flies_add_test(${target}_test SOURCES ${ARG_TESTS} LINK ${target} ${ARG_TEST_LINK})
  endif()
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
