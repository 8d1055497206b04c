#include "flies/eval/footprint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace flies {
namespace {

/// A point or direction in the rectangle's own axes: along its length and to its left.
struct Local {
  double along = 0.0;
  double across = 0.0;
};

Local rotate_into(const Footprint& footprint, double x, double y) {
  const double c = std::cos(footprint.yaw_rad), s = std::sin(footprint.yaw_rad);
  return {c * x + s * y, -s * x + c * y};
}

}  // namespace

double distance_to_footprint_m(const Footprint& footprint, double x_m, double y_m) {
  const Local point = rotate_into(footprint, x_m - footprint.x_m, y_m - footprint.y_m);
  return std::hypot(std::max(0.0, std::abs(point.along) - footprint.length_m / 2),
                    std::max(0.0, std::abs(point.across) - footprint.width_m / 2));
}

double near_range_m(const Footprint& footprint) { return distance_to_footprint_m(footprint, 0.0, 0.0); }

std::optional<double> near_face_range_m(const Footprint& footprint, double azimuth_rad) {
  const Local start = rotate_into(footprint, -footprint.x_m, -footprint.y_m);
  const Local step = rotate_into(footprint, std::cos(azimuth_rad), std::sin(azimuth_rad));
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  for (const auto& [position, direction, half] : {std::array{start.along, step.along, footprint.length_m / 2},
                                                  std::array{start.across, step.across, footprint.width_m / 2}}) {
    if (direction == 0.0) {
      if (std::abs(position) > half) return std::nullopt;
      continue;
    }
    const double first = (-half - position) / direction, second = (half - position) / direction;
    enter = std::max(enter, std::min(first, second));
    leave = std::min(leave, std::max(first, second));
  }
  if (enter > leave) return std::nullopt;
  return enter;
}

double seen_width_m(const Footprint& footprint) {
  const double angle = footprint.yaw_rad - std::atan2(footprint.y_m, footprint.x_m);
  return footprint.length_m * std::abs(std::sin(angle)) + footprint.width_m * std::abs(std::cos(angle));
}

double seen_depth_m(const Footprint& footprint) {
  const double range_m = std::hypot(footprint.x_m, footprint.y_m);
  if (range_m == 0.0) return 0.0;
  const Local eye = rotate_into(footprint, -footprint.x_m, -footprint.y_m);
  const double half_along = footprint.length_m / 2, half_across = footprint.width_m / 2;
  double near_m = std::numeric_limits<double>::infinity(), far_m = -near_m;
  for (const double along : {-half_along, half_along})
    for (const double across : {-half_across, half_across}) {
      // A corner is seen when one of the two faces that meet in it is turned to the eye.
      const bool is_seen =
          along * eye.along > half_along * half_along || across * eye.across > half_across * half_across;
      if (!is_seen) continue;
      const double depth_m = -(along * eye.along + across * eye.across) / range_m;  // less that of its centre
      near_m = std::min(near_m, depth_m);
      far_m = std::max(far_m, depth_m);
    }
  return std::max(0.0, far_m - near_m);
}

}  // namespace flies
