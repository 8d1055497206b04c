# Run by ctest with build_dir, consumer_dir, work_dir, compiler, python and sanitize set: installs the build tree, whole
# and static, and uses what is there.
include(${CMAKE_CURRENT_LIST_DIR}/use_installed.cmake)

file(REMOVE_RECURSE ${work_dir})
run(${CMAKE_COMMAND} --install ${build_dir} --prefix ${work_dir}/prefix)
build_with_cmake(-D WITH_COMPONENTS=ON)
run(${work_dir}/build/consumer)
run(${work_dir}/build/components ${work_dir}/calib.yaml)
build_with_pkg_config(main flies --static)
run(${work_dir}/main)
build_with_pkg_config(components flies-io flies-track --static)
run(${work_dir}/components ${work_dir}/calib.yaml)

# Who only detects loads no OpenCV.
needed_libraries(${work_dir}/build/consumer libraries)
if(NOT libraries MATCHES "libtbb" OR libraries MATCHES "opencv|yaml|png|embree")
  message(FATAL_ERROR "the consumer loads ${libraries}")
endif()

# The program must also work from where it was installed.
run(${work_dir}/prefix/bin/flies --version)

# And the Python package, where it was built.
file(GLOB package ${work_dir}/prefix/lib/python3/dist-packages/flies/_flies*.so)
if(package)
  run(${CMAKE_COMMAND} -E env PYTHONPATH=${work_dir}/prefix/lib/python3/dist-packages PYTHONDONTWRITEBYTECODE=1
    ${python} -c "import flies; print(flies.Detector(flies.StereoCamera(400, 400, 320, 120, 0.5)))")
endif()
