#include "flies/pipeline/ghosts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace flies::detail {

FieldOptions lived_in(const FieldOptions& reported, const StereoCamera& camera) {
  constexpr double kHardlyKnown = 0.1;  // standard deviation of a range, as a share of it
  constexpr double kBeyond_px = 1.5, kLeast_px = 0.25;
  FieldOptions field = reported;
  if (range_deviation_m(camera, reported.x_max_m) < kHardlyKnown * reported.x_max_m) return field;
  const double scale = camera.fx_px * camera.baseline_m;
  field.x_max_m = std::max(reported.x_max_m, scale / std::max(scale / reported.x_max_m - kBeyond_px, kLeast_px));
  return field;
}

int flies_in(const FieldOptions& lived, const FieldOptions& reported, int flies) {
  constexpr double kMost = 4.0;
  const double larger = std::log(lived.x_max_m / lived.x_min_m) / std::log(reported.x_max_m / reported.x_min_m);
  return static_cast<int>(std::lround(std::min(larger, kMost) * flies));
}

bool is_seen_through(const Obstacle& obstacle, const Scan& scan) {
  constexpr double kTall_m = 1.0, kFarBehind = 1.5;  // times its range
  if (scan.empty() || obstacle.height_m < kTall_m) return false;
  const double angle_rad = std::atan2(obstacle.y_m, obstacle.x_m);
  const double half_rad = std::atan2(0.5 * obstacle.width_m, obstacle.range_m);
  const auto sector_of = [&](double at_rad) {
    return static_cast<std::ptrdiff_t>(std::floor((at_rad - scan.angle_min_rad) / scan.angle_increment_rad + 0.5));
  };
  const auto first = sector_of(angle_rad - half_rad), last = sector_of(angle_rad + half_rad);
  if (first < 0 || last >= static_cast<std::ptrdiff_t>(scan.size())) return false;
  return std::all_of(scan.free_m.begin() + first, scan.free_m.begin() + last + 1,
                     [&](double free_m) { return free_m > kFarBehind * obstacle.range_m; });
}

void drop(const std::function<bool(const Obstacle&)>& is_dropped, ConcentrateResult& found) {
  constexpr int kNone = -1;
  std::vector<int> number(found.obstacles.size(), kNone);
  std::vector<Obstacle> kept;
  for (std::size_t i = 0; i < found.obstacles.size(); ++i) {
    if (is_dropped(found.obstacles[i])) continue;
    number[i] = static_cast<int>(kept.size());
    kept.push_back(found.obstacles[i]);
  }
  found.obstacles = std::move(kept);
  for (int& obstacle : found.obstacle_of_fly)
    if (obstacle != kNone) obstacle = number[static_cast<std::size_t>(obstacle)];
}

}  // namespace flies::detail
