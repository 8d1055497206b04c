# How installed libraries are found: by CMake and by pkg-config.
include(CMakePackageConfigHelpers)

set(FLIES_NEEDS_LIBRARIES ON)
if(BUILD_SHARED_LIBS)
  set(FLIES_NEEDS_LIBRARIES OFF)
endif()
set(folder ${CMAKE_INSTALL_LIBDIR}/cmake/flies)
configure_package_config_file(cmake/flies-config.cmake.in flies-config.cmake INSTALL_DESTINATION ${folder})
write_basic_package_version_file(flies-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/flies-config.cmake ${PROJECT_BINARY_DIR}/flies-config-version.cmake
  cmake/FliesOpenCV.cmake cmake/FliesPlainLibrary.cmake
  DESTINATION ${folder} COMPONENT development)

# flies_describe(<component> <pkg-config name> DESCRIPTION ... REQUIRES ... PACKAGES ... LIBS ...): what pkg-config says.
function(flies_describe component name)
  cmake_parse_arguments(PARSE_ARGV 2 ARG "" "DESCRIPTION" "REQUIRES;PACKAGES;LIBS")
  install(FILES cmake/flies-${component}-dependencies.cmake DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/flies
    COMPONENT development)
  # The folder of the libraries, from that of the file: the package may be moved.
  file(RELATIVE_PATH prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  set(library ${name})
  string(REPLACE "-" "_" library ${name})
  string(REGEX REPLACE "/$" "" prefix ${prefix})
  if(BUILD_SHARED_LIBS)  # which know themselves what they need
    set(ARG_PACKAGES)
    set(ARG_LIBS)
  endif()
  list(JOIN ARG_REQUIRES " " requires)
  list(JOIN ARG_PACKAGES " " packages)
  list(JOIN ARG_LIBS " " libs)
  configure_file(cmake/flies.pc.in ${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()
flies_describe(detect flies DESCRIPTION "obstacles and pedestrians from a stereo pair" PACKAGES fmt tbb libhwy)
if(FLIES_BUILD_IO)
  flies_describe(io flies-io DESCRIPTION "images, calibrations and people models for flies" REQUIRES flies
    PACKAGES libjpeg libpng libtiff-4 libwebp yaml-cpp pugixml
    LIBS -lopencv_dnn -lopencv_objdetect -lopencv_calib3d -lopencv_imgproc -lopencv_core)
endif()
if(FLIES_BUILD_TRACK)
  flies_describe(track flies-track DESCRIPTION "ego-motion and tracks for flies" REQUIRES flies
    LIBS -lopencv_video -lopencv_features2d -lopencv_imgproc -lopencv_calib3d -lopencv_core)
endif()
