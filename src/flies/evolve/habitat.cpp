#include "flies/evolve/habitat.hpp"

#include <algorithm>
#include <cmath>

namespace flies {

Habitat::Habitat(const Projection& projection, const RectifiedPair& pair, const RoadPlane& road,
                 const FieldOptions& field)
    : projection_(projection),
      pair_(pair),
      road_(road),
      field_(field),
      camera_above_road_m_(projection.height_m() - road.height_m),
      far_q_px_(projection.disparity_at_depth(field.x_max_m) - projection.disparity_offset_px()),
      near_q_px_(projection.disparity_at_depth(field.x_min_m) - projection.disparity_offset_px()) {
  // Where q = 1, the coordinates relative to the camera are the linear functions themselves.
  const auto ray = [&](double u_px, double v_px) {
    Point3 p = projection.triangulate({u_px, v_px, projection.disparity_offset_px() + 1.0});
    p.z_m -= projection.height_m();
    return p;
  };
  const Point3 origin = ray(0, 0), right = ray(1, 0), below = ray(0, 1);
  const auto linear = [&](auto coordinate) {
    const double at_origin = coordinate(origin);
    return Linear{at_origin, coordinate(right) - at_origin, coordinate(below) - at_origin};
  };
  x_ = linear([](const Point3& p) { return p.x_m; });
  y_ = linear([](const Point3& p) { return p.y_m; });
  z_ = linear([](const Point3& p) { return p.z_m; });
  height_ = linear([&](const Point3& p) { return p.z_m - road.slope * p.x_m - road.bank * p.y_m; });

  // A bound of the field, bound * q <= or >= coordinate, bounds q from one side, by its sign from the other.
  const auto restrict_to = [&](double least, const Linear& coordinate, double most) {
    const auto over = [&](double bound) {
      return Linear{coordinate.constant / bound, coordinate.per_u / bound, coordinate.per_v / bound};
    };
    if (least > 0.0) most_q_.add(over(least));
    if (least < 0.0) least_q_.add(over(least));
    if (most > 0.0) least_q_.add(over(most));
    if (most < 0.0) most_q_.add(over(most));
  };
  least_q_.add({far_q_px_, 0.0, 0.0});
  most_q_.add({near_q_px_, 0.0, 0.0});
  restrict_to(field.x_min_m, x_, field.x_max_m);
  restrict_to(field.y_min_m, y_, field.y_max_m);
  restrict_to(field.z_min_m - camera_above_road_m_, height_, field.z_max_m - camera_above_road_m_);

  for (std::size_t i = 0; i < q_at_ratios_.size(); ++i)
    q_at_ratios_[i] = static_cast<float>(far_q_px_ * std::pow(near_q_px_ / far_q_px_, static_cast<double>(i) / kSteps));
}

Habitat::Sight Habitat::sight(double u_px, double v_px) const {
  const StereoPoint place{u_px, v_px, 0.0};
  Sight sight{far_q_px_, near_q_px_};
  for (const auto& bound : least_q()) sight.least_q_px = std::max(sight.least_q_px, bound.at(place));
  for (const auto& bound : most_q()) sight.most_q_px = std::min(sight.most_q_px, bound.at(place));
  return sight;
}

StereoPoint Habitat::at_height(double u_px, double height_m, double disparity_px) const {
  const double q = disparity_px - projection_.disparity_offset_px();
  const double height = (height_m - camera_above_road_m_) * q;
  return {u_px, (height - height_.constant - height_.per_u * u_px) / height_.per_v, disparity_px};
}

}  // namespace flies
