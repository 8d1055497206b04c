#pragma once

#include <optional>

#include "flies/core/stereo_camera.hpp"

namespace flies {

/// A point as KITTI's files have it: in the axes of the left camera, which pitch and roll with it.
struct KittiPlace {
  double right_m = 0.0;
  double down_m = 0.0;
  double forward_m = 0.0;  ///< along the optical axis, > 0
};

/// @returns nothing of a point that is not before the camera, which KITTI does not label
std::optional<KittiPlace> kitti_place(const StereoCamera& camera, const Point3& point_in_vehicle);

/// KITTI's `rotation_y`, -pi to pi, of a yaw in the vehicle frame: it is about the camera's downward axis from its
/// rightward one, ours about the upward axis from the forward one.
double kitti_heading_rad(double yaw_rad);

/// An angle brought to -pi to pi.
double wrapped_rad(double angle_rad);

}  // namespace flies
