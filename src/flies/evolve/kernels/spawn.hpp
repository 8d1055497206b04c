#pragma once

#include <cstddef>
#include <cstdint>

#include "flies/core/gray_view.hpp"

namespace flies::kernels {

/// A linear function of a place in the image.
struct Linear {
  float constant, per_u, per_v;
};

/// How flies are drawn uniform in image column, height above the road and disparity, and which draws are kept.
struct SpawnSearch {
  GrayView left, right;  ///< at least `kMinWidth_px` wide
  float infinity_px;     ///< disparity of a point at infinity; q below is a disparity less this one
  float min_q, span_q;   ///< q is uniform in [min_q, min_q + span_q)
  float min_m, span_m;   ///< likewise the height above the road
  float v_per_height_q;  ///< v = (height * v_per_height_q + v_per_q) * q + v_constant + v_per_u * u
  float v_per_q, v_constant, v_per_u;
  Linear x, y;                               ///< coordinates in the vehicle frame times q
  float x_min_m, x_max_m, y_min_m, y_max_m;  ///< the field
  int min_contrast;                          ///< least row contrast of a draw that is kept
  float min_likeness;                        ///< least row likeness of a draw that is kept; 0: none is asked for
  int max_draws;
  std::uint64_t seed;
  std::uint32_t purpose, generation;  ///< of FlyDraws
};

/// Columns of the windows of which contrast and likeness are taken.
constexpr int kMinWidth_px = 13;

/// Sums over the columns of a window in the left (l) and in the right image (r), and of their squares and products.
struct WindowSums {
  std::int32_t l, r, ll, lr, rr;

  /// Whether the correlation coefficient, lowered by the noise of the images as the fitness does, is `least` (> 0).
  bool alike(float least) const {
    constexpr double kNoise_gray = 2.0;
    constexpr double n = kMinWidth_px, noise = n * n * kNoise_gray * kNoise_gray;
    const double covariance = n * lr - 1.0 * l * r;
    const double left = n * ll - 1.0 * l * l + noise, right = n * rr - 1.0 * r * r + noise;
    return covariance > 0.0 && covariance * covariance >= 1.0 * least * least * (left * right);
  }
};
WindowSums sum_windows(const std::uint8_t* left, const std::uint8_t* right);

/// Draws the flies `first_fly`, ... `first_fly + count - 1`, each by the numbers of its own FlyDraws, until a draw is
/// in the field and the image and has the contrast, `max_draws` times at most. The same numbers on every CPU.
/// @param u_px, v_px, disparity_px `count` values each
void spawn_flies(const SpawnSearch& search, std::uint32_t first_fly, std::size_t count, float* u_px, float* v_px,
                 float* disparity_px);

}  // namespace flies::kernels
