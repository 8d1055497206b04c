#include "flies/pipeline/far_end.hpp"

#include <algorithm>
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

void drop_beyond(double x_max_m, ConcentrateResult& found) {
  constexpr int kNone = -1;
  std::vector<int> number(found.obstacles.size(), kNone);
  std::vector<Obstacle> kept;
  for (std::size_t i = 0; i < found.obstacles.size(); ++i) {
    if (found.obstacles[i].x_m > x_max_m) continue;
    number[i] = static_cast<int>(kept.size());
    kept.push_back(std::move(found.obstacles[i]));
  }
  found.obstacles = std::move(kept);
  for (int& obstacle : found.obstacle_of_fly)
    if (obstacle != kNone) obstacle = number[static_cast<std::size_t>(obstacle)];
}

}  // namespace flies::detail
