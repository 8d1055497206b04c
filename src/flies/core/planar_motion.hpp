#pragma once

#include <cmath>
#include <functional>
#include <optional>

#include "flies/core/stereo_camera.hpp"

namespace flies {

/// How the vehicle moved from the pair before to this one in the plane of the road: the pose of its frame now in its
/// frame then.
struct PlanarMotion {
  double forward_m = 0.0;
  double left_m = 0.0;
  double turn_rad = 0.0;  ///< positive to the left

  /// This motion and after it another one, as one: the pose at the end of `next` in the frame at the beginning of this.
  PlanarMotion then(const PlanarMotion& next) const {
    const Point3 end = before({next.forward_m, next.left_m, 0.0});
    return {end.x_m, end.y_m, turn_rad + next.turn_rad};
  }
  /// Where something that stands still was in the frame of the pair before.
  Point3 before(const Point3& now) const {
    const double c = std::cos(turn_rad), s = std::sin(turn_rad);
    return {forward_m + c * now.x_m - s * now.y_m, left_m + s * now.x_m + c * now.y_m, now.z_m};
  }
  /// Where something that stood there in the frame of the pair before is now.
  Point3 now(const Point3& before) const {
    const double c = std::cos(turn_rad), s = std::sin(turn_rad);
    const double x_m = before.x_m - forward_m, y_m = before.y_m - left_m;
    return {c * x_m + s * y_m, -s * x_m + c * y_m, before.z_m};
  }
};

/// Says the motion, or that it is not known, when it is needed; until then it may be measured on another thread.
using MotionSource = std::function<std::optional<PlanarMotion>()>;

}  // namespace flies
