#include "flies/eval/bearings.hpp"

#include <algorithm>
#include <cmath>

namespace flies {
namespace {

constexpr double kCommonDepth_m = 45.0;  // nearer things at the left end of the view are seen by the left camera alone

}  // namespace

std::optional<std::size_t> Bearings::sector_of(double angle_rad) const {
  const double sector = std::floor((angle_rad - angle_min_rad) / angle_increment_rad + 0.5);
  if (!(sector >= 0.0 && sector < static_cast<double>(count))) return std::nullopt;
  return static_cast<std::size_t>(sector);
}

Bearings common_view(const StereoCamera& camera, double increment_rad) {
  const double first_px = std::max(0.0, Projection(camera).disparity_at_depth(kCommonDepth_m));
  const double left_rad = std::atan((camera.cx_px - first_px) / camera.fx_px);
  const double right_rad = -std::atan((camera.width_px - 1 - camera.cx_px) / camera.fx_px);
  const double first = std::ceil(right_rad / increment_rad), end = std::floor(left_rad / increment_rad);
  return {(first + 0.5) * increment_rad, increment_rad, static_cast<std::size_t>(std::max(0.0, end - first))};
}

std::optional<double> shared_range_m(const std::vector<double>& ranges_m, std::size_t need, double gap_m,
                                     double gap_per_range, double quantile) {
  for (std::size_t i = 0; need > 0 && i + need <= ranges_m.size(); ++i)
    if (ranges_m[i + need - 1] - ranges_m[i] <= gap_m + gap_per_range * ranges_m[i])
      return ranges_m[i + static_cast<std::size_t>(quantile * static_cast<double>(need - 1))];
  return std::nullopt;
}

}  // namespace flies
