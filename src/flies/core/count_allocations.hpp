#pragma once

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

/// For tests: counts what the program allocates. Replaces the allocation functions of the whole program, so at most one
/// source of it includes this. The sized and array forms of the library come down to these. Not inlined, because g++
/// takes an inlined delete beside a new that is not for a mismatch.
namespace flies::testing {
inline std::atomic<std::size_t> allocations = 0;
}  // namespace flies::testing

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++flies::testing::allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++flies::testing::allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
