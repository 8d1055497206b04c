# Run by ctest with source_dir, consumer_dir, work_dir, compiler and launcher set: builds the part that detects, alone and
# shared, without OpenCV, and uses it. Not optimised, for the sake of time.
include(${CMAKE_CURRENT_LIST_DIR}/use_installed.cmake)

file(REMOVE_RECURSE ${work_dir}/prefix ${work_dir}/build)
set(without)
foreach(part IN ITEMS PROGRAM IO TRACK)
  list(APPEND without -D FLIES_BUILD_${part}=OFF)
endforeach()
foreach(package IN ITEMS OpenCV JPEG PNG TIFF yaml-cpp pugixml embree CLI11 GTest)
  list(APPEND without -D CMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
run(${CMAKE_COMMAND} -G Ninja -S ${source_dir} -B ${work_dir}/library -D BUILD_SHARED_LIBS=ON ${without}
  -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_FLAGS_DEBUG=-O0 -D CMAKE_CXX_COMPILER=${compiler}
  -D CMAKE_CXX_COMPILER_LAUNCHER=${launcher} -D CMAKE_INSTALL_PREFIX=${work_dir}/prefix)
run(${CMAKE_COMMAND} --build ${work_dir}/library --target install)
build_with_cmake()
run(${work_dir}/build/consumer)
needed_libraries(${work_dir}/build/consumer libraries)
if(NOT libraries MATCHES "libflies\\.so\\.0\\.1")
  message(FATAL_ERROR "the consumer loads ${libraries}, expected libflies.so.0.1")
endif()
file(GLOB_RECURSE library ${work_dir}/prefix/libflies.so.0.1.0)
needed_libraries(${library} libraries)
if(libraries MATCHES "opencv|yaml|png")
  message(FATAL_ERROR "libflies loads ${libraries}")
endif()

build_with_pkg_config(main flies)
cmake_path(GET library PARENT_PATH folder)
run(${CMAKE_COMMAND} -E env LD_LIBRARY_PATH=${folder} ${work_dir}/main)
