#include "flies/propose/scan_stretches.hpp"

#include <algorithm>
#include <cmath>

namespace flies {
namespace {

/// Boxes of an obstacle serve a sector whose range differs by less than this and a share of the range: as long as a
/// window is about as large there.
constexpr double kSameRange_m = 0.75, kSameRangeShare = 0.05;

/// Neighbouring sectors of one surface differ by less than this and a share of their range, all of a stretch by less
/// than that.
constexpr double kStep_m = 0.4, kStepShare = 0.03;
constexpr double kDepth_m = 0.5, kDepthShare = 0.05;

class Stretches {
 public:
  Stretches(std::span<const Obstacle> obstacles, const Scan& scan, const ProposeOptions& options)
      : obstacles_(obstacles), scan_(scan), options_(options) {}

  /// Whether the sector shows something that has no boxes yet.
  bool is_open(std::size_t sector) const {
    return scan_.states[sector] == SectorState::obstacle &&
           std::none_of(obstacles_.begin(), obstacles_.end(),
                        [&](const Obstacle& obstacle) { return covers(obstacle, sector); });
  }

  /// The last sector of the stretch that begins with this one.
  std::size_t end_of(std::size_t first) const {
    const double widest_m = 2.0 * std::max(0.0, options_.max_lateral_m - options_.lateral_margin_m);
    double near_m = scan_.ranges_m[first], far_m = near_m;
    std::size_t last = first;
    while (last + 1 < scan_.size() && is_open(last + 1)) {
      const double range_m = scan_.ranges_m[last + 1];
      near_m = std::min(near_m, range_m);
      far_m = std::max(far_m, range_m);
      if (std::abs(range_m - scan_.ranges_m[last]) > kStep_m + kStepShare * near_m ||
          far_m - near_m > kDepth_m + kDepthShare * near_m || width_m(first, last + 1, near_m) > widest_m)
        break;
      ++last;
    }
    return last;
  }

  Obstacle obstacle(std::size_t first, std::size_t last, const RoadPlane& road) const {
    const auto from = scan_.ranges_m.begin() + static_cast<std::ptrdiff_t>(first);
    const auto [near, far] = std::minmax_element(from, from + static_cast<std::ptrdiff_t>(last - first + 1));
    const double azimuth_rad = (scan_.angle_rad(first) + scan_.angle_rad(last)) / 2.0;
    Obstacle stretch;
    stretch.range_m = (*near + *far) / 2.0;
    stretch.x_m = stretch.range_m * std::cos(azimuth_rad);
    stretch.y_m = stretch.range_m * std::sin(azimuth_rad);
    stretch.width_m = width_m(first, last, *near);
    stretch.height_m = options_.max_height_m;
    stretch.ground_z_m = road.z_m(stretch.x_m, stretch.y_m);
    return stretch;
  }

 private:
  double width_m(std::size_t first, std::size_t last, double range_m) const {
    return range_m * scan_.angle_increment_rad * static_cast<double>(last - first + 1);
  }

  bool covers(const Obstacle& obstacle, std::size_t sector) const {
    const double range_m = scan_.ranges_m[sector];
    const double across_m = range_m * std::abs(std::atan2(obstacle.y_m, obstacle.x_m) - scan_.angle_rad(sector));
    return obstacle.height_m >= options_.min_obstacle_height_m &&
           std::abs(obstacle.range_m - range_m) < kSameRange_m + kSameRangeShare * range_m &&
           across_m < std::min(obstacle.width_m / 2.0 + options_.lateral_margin_m, options_.max_lateral_m);
  }

  std::span<const Obstacle> obstacles_;
  const Scan& scan_;
  const ProposeOptions& options_;
};

}  // namespace

std::vector<Obstacle> scan_stretches(std::span<const Obstacle> obstacles, const Scan& scan, const RoadPlane& road,
                                     const ProposeOptions& options) {
  std::vector<Obstacle> found;
  const Stretches stretches(obstacles, scan, options);
  for (std::size_t first = 0; first < scan.size(); ++first) {
    if (!stretches.is_open(first)) continue;
    const std::size_t last = stretches.end_of(first);
    const Obstacle stretch = stretches.obstacle(first, last, road);
    if (stretch.width_m >= options.min_stretch_m) found.push_back(stretch);
    first = last;
  }
  return found;
}

}  // namespace flies
