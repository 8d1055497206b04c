# What `cpack -G DEB` makes, from the preset `package`: libflies0.1, flies, libflies-dev, python3-flies, flies-doc.
set(abi ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(FLIES_DEB_library libflies${abi})
set(FLIES_DEB_program flies)
set(FLIES_DEB_development libflies-dev)
set(FLIES_DEB_python python3-flies)
set(FLIES_DEB_documentation flies-doc)
set(components library program development python documentation)

# Every package says whose it is and what changed.
file(READ ${PROJECT_SOURCE_DIR}/LICENSE licence)
string(REGEX REPLACE "^MIT License[^P]*\n\n" "" licence "${licence}")
string(REGEX REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REGEX REPLACE "\n$" "" licence "${licence}")
string(REGEX REPLACE "\n" "\n " licence " ${licence}")
configure_file(packaging/copyright.in packages/copyright @ONLY)
set(ENV{LC_ALL} C)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(packaging/changelog.in packages/changelog @ONLY)
execute_process(COMMAND gzip -9n -f ${PROJECT_BINARY_DIR}/packages/changelog COMMAND_ERROR_IS_FATAL ANY)
foreach(component IN LISTS components)
  install(FILES ${PROJECT_BINARY_DIR}/packages/copyright ${PROJECT_BINARY_DIR}/packages/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${FLIES_DEB_${component}} COMPONENT ${component})
endforeach()

# Manual pages and completions come from the program itself.
find_program(FLIES_HELP2MAN help2man REQUIRED)
set(texts ${PROJECT_BINARY_DIR}/packages/texts)
add_custom_command(OUTPUT ${texts}/done
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${texts}
  COMMAND ${PROJECT_SOURCE_DIR}/packaging/make-manual $<TARGET_FILE:flies_cli> ${texts}/man1
  COMMAND sh -c "gzip -9n ${texts}/man1/*.1"
  COMMAND sh -c "$<TARGET_FILE:flies_cli> completion bash > ${texts}/flies"
  COMMAND sh -c "$<TARGET_FILE:flies_cli> completion zsh > ${texts}/_flies"
  COMMAND ${CMAKE_COMMAND} -E touch ${texts}/done
  DEPENDS flies_cli ${PROJECT_SOURCE_DIR}/packaging/make-manual VERBATIM)
add_custom_target(flies_texts ALL DEPENDS ${texts}/done)
install(DIRECTORY ${texts}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
install(FILES ${texts}/flies DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(FILES ${texts}/_flies DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)

set(documents ${CMAKE_INSTALL_DATADIR}/doc/flies-doc)
install(FILES README.md CHANGELOG.md SECURITY.md DESTINATION ${documents} COMPONENT documentation)
install(DIRECTORY docs examples DESTINATION ${documents} COMPONENT documentation
  PATTERN CMakeLists.txt EXCLUDE PATTERN __pycache__ EXCLUDE)

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_VENDOR "The flies authors")
set(CPACK_PACKAGE_CONTACT "The flies authors <flies@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/src/flies)
set(CPACK_DEBIAN_PACKAGE_SECTION science)

set(about " Stereo vision without a dense disparity map: thousands of 3-D points, the flies,
 evolve towards visible surfaces and are condensed into obstacles in metres;
 a classifier tells which of them are pedestrians.")
set(same "(= ${PROJECT_VERSION})")
function(flies_package component section summary text depends)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${FLIES_DEB_${component}} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}\n${about}\n .\n ${text}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${about}\n .\n ${text}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
endfunction()
flies_package(library libs "obstacles and pedestrians from a stereo camera, shared libraries"
  "This package contains the shared libraries." "")
flies_package(program science "obstacles and pedestrians from a stereo camera"
  "This package contains the program flies." "libflies${abi} ${same}")
flies_package(development libdevel "obstacles and pedestrians from a stereo camera, headers"
  "This package contains what C++ programs are built with."
  "libflies${abi} ${same}, libfmt-dev, libtbb-dev, libhwy-dev")
flies_package(python python "obstacles and pedestrians from a stereo camera, for Python"
  "This package contains the module flies for Python 3." "libflies${abi} ${same}, python3, python3-numpy")
flies_package(documentation doc "obstacles and pedestrians from a stereo camera, documentation"
  "This package contains the documentation and examples." "")
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/triggers)
include(CPack)
