#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "flies/core/stereo_camera.hpp"

namespace flies {

/// Sectors of equal width, counted from the rightmost: angles are measured from straight ahead (x) in the ground plane
/// and grow to the left, as those of a `Scan`.
struct Bearings {
  double angle_min_rad = 0.0;        ///< middle of the first sector
  double angle_increment_rad = 0.0;  ///< width of a sector, > 0
  std::size_t count = 0;

  double angle_rad(std::size_t sector) const {
    return angle_min_rad + static_cast<double>(sector) * angle_increment_rad;
  }

  /// The sector that a direction lies in.
  std::optional<std::size_t> sector_of(double angle_rad) const;
};

/// Whole multiples of the increment that both cameras see of what stands as far as 45 m away.
Bearings common_view(const StereoCamera& camera, double increment_rad);

/// The nearest range that `need` of the ranges share: within `gap_m` plus `gap_per_range` of the nearest of them.
/// @param ranges_m in ascending order
/// @param quantile of the ranges that share it, which is returned: 0 the nearest of them, 0.5 the middle one
/// @returns nothing when so many never lie together
std::optional<double> shared_range_m(const std::vector<double>& ranges_m, std::size_t need, double gap_m,
                                     double gap_per_range, double quantile);

}  // namespace flies
