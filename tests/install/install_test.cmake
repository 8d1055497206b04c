# Run by ctest with build_dir, consumer_dir, work_dir, compiler and sanitize set.
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${work_dir})
run(${CMAKE_COMMAND} --install ${build_dir} --prefix ${work_dir}/prefix)

set(flags)
if(sanitize)
  # The libraries in the build tree refer to the sanitizer's run-time.
  set(flags -D CMAKE_CXX_FLAGS=-fsanitize=${sanitize})
endif()
run(${CMAKE_COMMAND} -G Ninja -S ${consumer_dir} -B ${work_dir}/build
  -D CMAKE_PREFIX_PATH=${work_dir}/prefix -D CMAKE_CXX_COMPILER=${compiler} ${flags})
run(${CMAKE_COMMAND} --build ${work_dir}/build)
run(${work_dir}/build/consumer)

# The program must also work from where it was installed.
run(${work_dir}/prefix/bin/flies --version)

# And the Python package, where it was built.
file(GLOB package ${work_dir}/prefix/lib/python3/dist-packages/flies/_flies*.so)
if(package)
  run(${CMAKE_COMMAND} -E env PYTHONPATH=${work_dir}/prefix/lib/python3/dist-packages PYTHONDONTWRITEBYTECODE=1
    ${python} -c "import flies; print(flies.Detector(flies.StereoCamera(400, 400, 320, 120, 0.5)))")
endif()
