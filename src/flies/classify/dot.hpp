#pragma once

#include <array>
#include <cstddef>

namespace flies {

/// Sums `term(i)` for i below `size` in single precision, in an order that the compiler makes vectors of and that is
/// the same on every machine.
template <class Term>
inline float sum_terms(std::size_t size, const Term& term) {
  constexpr std::size_t kLanes = 16;
  std::array<float, kLanes> sums{};
  std::size_t i = 0;
  for (; i + kLanes <= size; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += term(i + lane);
  for (std::size_t lane = 0; i < size; ++i, ++lane) sums[lane] += term(i);
  for (std::size_t half = kLanes / 2; half > 0; half /= 2)
    for (std::size_t lane = 0; lane < half; ++lane) sums[lane] += sums[lane + half];
  return sums[0];
}

inline float dot(const float* a, const float* b, std::size_t size) {
  return sum_terms(size, [=](std::size_t i) { return a[i] * b[i]; });
}

inline float squared_distance(const float* a, const float* b, std::size_t size) {
  return sum_terms(size, [=](std::size_t i) { return (a[i] - b[i]) * (a[i] - b[i]); });
}

}  // namespace flies
