#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace flies {

/// Sums in single precision, in an order that the compiler makes vectors of and that is the same on every machine:
/// every sixteenth term to one lane.
using Lanes = std::array<float, 16>;

/// Adds `term(i)` for i below `size`, the first to the first lane.
template <class Term>
inline void add_terms(Lanes& lanes, std::size_t size, const Term& term) {
  std::size_t i = 0;
  for (; i + lanes.size() <= size; i += lanes.size())
    for (std::size_t lane = 0; lane < lanes.size(); ++lane) lanes[lane] += term(i + lane);
  for (std::size_t lane = 0; i < size; ++i, ++lane) lanes[lane] += term(i);
}

inline float sum(Lanes lanes) {
  for (std::size_t half = lanes.size() / 2; half > 0; half /= 2)
    for (std::size_t lane = 0; lane < half; ++lane) lanes[lane] += lanes[lane + half];
  return lanes[0];
}

template <class Term>
inline float sum_terms(std::size_t size, const Term& term) {
  Lanes lanes{};
  add_terms(lanes, size, term);
  return sum(lanes);
}

inline float dot(const float* a, const float* b, std::size_t size) {
  return sum_terms(size, [=](std::size_t i) { return a[i] * b[i]; });
}

/// The same number as `dot` of `a` with `count` pieces of `b` joined.
/// @param size   of a piece
/// @param stride from the start of a piece to that of the next
inline float dot_of_pieces(const float* a, const float* b, std::size_t size, std::size_t stride, std::size_t count) {
  Lanes lanes{};
  const auto turn = [&](std::size_t terms) {
    std::rotate(lanes.begin(), lanes.begin() + static_cast<std::ptrdiff_t>(terms % lanes.size()), lanes.end());
  };
  for (std::size_t piece = 0; piece < count; ++piece, a += size, b += stride) {
    add_terms(lanes, size, [=](std::size_t i) { return a[i] * b[i]; });
    turn(size);  // the lane of the next term becomes the first
  }
  turn(lanes.size() - size * count % lanes.size());
  return sum(lanes);
}

inline float squared_distance(const float* a, const float* b, std::size_t size) {
  return sum_terms(size, [=](std::size_t i) { return (a[i] - b[i]) * (a[i] - b[i]); });
}

}  // namespace flies
