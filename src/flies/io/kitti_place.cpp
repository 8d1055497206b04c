#include "flies/io/kitti_place.hpp"

#include <cmath>
#include <numbers>

namespace flies {

std::optional<KittiPlace> kitti_place(const StereoCamera& camera, const Point3& point_in_vehicle) {
  const Projection projection(camera);
  const double depth_m = projection.depth_m(point_in_vehicle);
  if (!(depth_m > 0.0)) return std::nullopt;
  const StereoPoint image = projection.project(point_in_vehicle);
  return KittiPlace{.right_m = (image.u_px - camera.cx_px) / camera.fx_px * depth_m,
                    .down_m = (image.v_px - camera.cy_px) / camera.fy_px * depth_m,
                    .forward_m = depth_m};
}

double kitti_heading_rad(double yaw_rad) { return wrapped_rad(-yaw_rad - std::numbers::pi / 2.0); }

double wrapped_rad(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

}  // namespace flies
