#include "flies/core/people_obstacles.hpp"

#include <cmath>

namespace flies {
namespace {

constexpr double kMinGap_m = 0.7, kGapShare = 0.05;  // between a person and the middle of the obstacle he is

}  // namespace

GroundPoint middle_of(const Obstacle& obstacle) {
  const double turn_rad = obstacle.range_m > 0.0 ? obstacle.middle_offset_m / obstacle.range_m : 0.0;
  const double angle_rad = std::atan2(obstacle.y_m, obstacle.x_m) + turn_rad;
  const double range_m = std::hypot(obstacle.x_m, obstacle.y_m);
  return {range_m * std::cos(angle_rad), range_m * std::sin(angle_rad)};
}

std::vector<std::optional<std::size_t>> obstacles_of_people(std::span<const Obstacle> obstacles,
                                                            std::span<const Pedestrian> people) {
  std::vector<std::optional<std::size_t>> own(people.size());
  std::vector<bool> is_taken(obstacles.size());
  for (std::size_t k = 0; k < people.size(); ++k) {
    double nearest_m = kMinGap_m + kGapShare * people[k].range_m;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      const GroundPoint middle = middle_of(obstacles[i]);
      const double gap_m = std::hypot(middle.x_m - people[k].x_m, middle.y_m - people[k].y_m);
      if (is_taken[i] || !(gap_m < nearest_m)) continue;  // a gap that is no number is none
      nearest_m = gap_m;
      own[k] = i;
    }
    if (own[k]) is_taken[*own[k]] = true;
  }
  return own;
}

}  // namespace flies
