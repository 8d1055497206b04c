# What an attacker of a parser would miss: position-independent programs, a stack protector, checked copies, a table of
# addresses that is read-only once the program runs. Not with sanitizers, which see more.
option(FLIES_HARDENED "Build with a stack protector, _FORTIFY_SOURCE and read-only relocations" ON)
if(FLIES_HARDENED AND NOT FLIES_SANITIZE AND NOT FLIES_FUZZERS)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
  include(CheckPIESupported)
  check_pie_supported(LANGUAGES CXX)
  add_compile_options(-fstack-protector-strong "$<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>")
  add_link_options(LINKER:-z,relro,-z,now)
endif()
