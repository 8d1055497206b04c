# Steps that the tests of installed trees share. They read work_dir, consumer_dir, compiler and sanitize.
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# The libraries in the build tree refer to the sanitizer's run-time.
set(sanitizer_flag)
if(sanitize)
  set(sanitizer_flag -fsanitize=${sanitize})
endif()

# build_with_cmake(<arguments>): the consumer, by find_package.
function(build_with_cmake)
  run(${CMAKE_COMMAND} -G Ninja -S ${consumer_dir} -B ${work_dir}/build -D CMAKE_PREFIX_PATH=${work_dir}/prefix
    -D CMAKE_CXX_COMPILER=${compiler} -D CMAKE_CXX_FLAGS=${sanitizer_flag} ${ARGN})
  run(${CMAKE_COMMAND} --build ${work_dir}/build)
endfunction()

# build_with_pkg_config(<name> <packages and options>): name.cpp of the consumer.
function(build_with_pkg_config name)
  file(GLOB_RECURSE descriptions ${work_dir}/prefix/*/flies.pc)
  cmake_path(GET descriptions PARENT_PATH folder)
  set(ENV{PKG_CONFIG_PATH} ${folder})
  execute_process(COMMAND pkg-config --cflags --libs ${ARGN} OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE
    COMMAND_ERROR_IS_FATAL ANY COMMAND_ECHO STDOUT)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  set(opencv)
  if(name STREQUAL components)
    set(opencv -isystem /usr/include/opencv4)
  endif()
  run(${compiler} ${sanitizer_flag} ${opencv} ${consumer_dir}/${name}.cpp -o ${work_dir}/${name} ${flags})
endfunction()

# needed_libraries(<file> <variable>): what the file asks the loader for.
function(needed_libraries file variable)
  execute_process(COMMAND readelf -d ${file} OUTPUT_VARIABLE dynamic COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "\\(NEEDED\\)[^\n]*" needed "${dynamic}")
  set(${variable} "${needed}" PARENT_SCOPE)
endfunction()
