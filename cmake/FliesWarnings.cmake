# Warnings are always on; the presets dev, asan, tsan and tidy make them errors (FLIES_WARNINGS_AS_ERRORS).
function(flies_set_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wshadow)
  if(FLIES_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
