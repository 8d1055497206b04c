#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

/// For tests: counts what the program allocates. Replaces the allocation functions of the whole program, so at most one
/// source of it includes this. The sized and array forms of the library come down to these.
namespace flies::testing {
inline std::size_t allocations = 0;
}  // namespace flies::testing

void* operator new(std::size_t size) {
  ++flies::testing::allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++flies::testing::allocations;
  return std::malloc(size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
