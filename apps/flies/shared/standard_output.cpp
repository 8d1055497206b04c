#include "shared/standard_output.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "flies/core/error.hpp"

void print(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); }

void flush_standard_output() {
  std::cout.flush();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || std::cout.fail())
    throw flies::InputError("standard output", "", std::string("cannot write: ") + std::strerror(errno));
}
