#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "flies/core/gray_view.hpp"
#include "flies/evolve/kernels/spawn.hpp"

namespace flies::kernels {

/// Columns of a row that is compared; the width of the default patch.
constexpr int kRowColumns = 13;

/// Bounds the memory of one birth.
constexpr int kMaxScouts = 32;

/// Bounds of q (see SpawnSearch) that are linear in the place of the left image.
struct LinearBounds {
  std::array<Linear, 8> bounds;
  std::size_t count = 0;

  void add(const Linear& bound) { bounds[count++] = bound; }
};

/// How other disparities are tried for flies.
struct ScoutSearch {
  GrayView left, right;
  float infinity_px;      ///< disparity of a point at infinity; q below is a disparity less this one
  LinearBounds farthest;  ///< q is at least the largest of these
  LinearBounds nearest;   ///< and at most the smallest of these
  int scouts;             ///< 1 to kMaxScouts
  float noise;            ///< keeps rows without contrast from looking alike: added to n^2 times a row's variance
  std::uint64_t seed;
  std::uint32_t purpose, generation;  ///< of FlyDraws
};

/// Moves each of the flies `first_fly`, ... `first_fly + count - 1` on its line of sight to one of `scouts` disparities
/// at equal ratios, at a random place each in its own of equal steps: to the one whose row of pixels correlates best in
/// both images. Leaves a fly where a row leaves the left image or no disparity is in bounds. The same numbers on every
/// CPU.
/// @param u_px, v_px, disparity_px `count` values each
void scout_flies(const ScoutSearch& search, std::uint32_t first_fly, std::size_t count, const float* u_px,
                 const float* v_px, float* disparity_px);

}  // namespace flies::kernels
