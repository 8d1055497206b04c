#pragma once

#include <cstddef>
#include <cstdint>

#include "flies/core/gray_view.hpp"

namespace flies::kernels {

/// A linear function of a place in the image.
struct Linear {
  float constant, per_u, per_v;
};

/// How flies are drawn uniform in image column, height above the road and disparity or its logarithm, and which draws
/// are kept.
struct SpawnSearch {
  GrayView left;             ///< at least `kMinWidth_px` wide
  float infinity_px;         ///< disparity of a point at infinity; q below is a disparity less this one
  float min_q, span_q;       ///< q is uniform in [min_q, min_q + span_q)
  const float* q_at_ratios;  ///< unless this is given: q at `kRatioSteps` equal ratios, and at two more
  float min_m, span_m;       ///< likewise the height above the road
  float v_per_height_q;      ///< v = (height * v_per_height_q + v_per_q) * q + v_constant + v_per_u * u
  float v_per_q, v_constant, v_per_u;
  Linear x, y;                               ///< coordinates in the vehicle frame times q
  float x_min_m, x_max_m, y_min_m, y_max_m;  ///< the field
  int min_contrast;                          ///< least row contrast of a draw that is kept
  int max_draws;
  std::uint64_t seed;
  std::uint32_t purpose, generation;  ///< of FlyDraws
};

/// Columns of the window of which the contrast is taken.
constexpr int kMinWidth_px = 13;

constexpr int kRatioSteps = 256;

/// Draws the flies `first_fly`, ... `first_fly + count - 1`, each by the numbers of its own FlyDraws, until a draw is
/// in the field and the image and has the contrast, `max_draws` times at most. The same numbers on every CPU.
/// @param u_px, v_px, disparity_px `count` values each
void spawn_flies(const SpawnSearch& search, std::uint32_t first_fly, std::size_t count, float* u_px, float* v_px,
                 float* disparity_px);

}  // namespace flies::kernels
