#include "shared/notes.hpp"

#include <cstdio>

void say_notes(const std::vector<std::string>& notes) {
  for (const auto& note : notes) std::fprintf(stderr, "flies: note: %s\n", note.c_str());
}
