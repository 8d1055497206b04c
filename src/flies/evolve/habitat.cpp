#include "flies/evolve/habitat.hpp"

namespace flies {

Habitat::Habitat(const Projection& projection, const RectifiedPair& pair, const RoadPlane& road,
                 const FieldOptions& field)
    : projection_(projection),
      pair_(pair),
      road_(road),
      field_(field),
      camera_above_road_m_(projection.height_m() - road.height_m) {
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
}

bool Habitat::holds(const StereoPoint& fly) const {
  const double q = fly.disparity_px - projection_.disparity_offset_px();
  const auto between = [](double low, double value, double high) { return value >= low && value <= high; };
  return q > 0.0 && between(0.0, fly.u_px, left().width_px - 1) && between(0.0, fly.v_px, left().height_px - 1) &&
         between(field_.x_min_m * q, x_.at(fly), field_.x_max_m * q) &&
         between(field_.y_min_m * q, y_.at(fly), field_.y_max_m * q) &&
         between((field_.z_min_m - camera_above_road_m_) * q, height_.at(fly),
                 (field_.z_max_m - camera_above_road_m_) * q);
}

StereoPoint Habitat::at_height(double u_px, double height_m, double disparity_px) const {
  const double q = disparity_px - projection_.disparity_offset_px();
  const double height = (height_m - camera_above_road_m_) * q;
  return {u_px, (height - height_.constant - height_.per_u * u_px) / height_.per_v, disparity_px};
}

Point3 Habitat::point(const StereoPoint& fly) const {
  const double per_q = 1.0 / (fly.disparity_px - projection_.disparity_offset_px());
  return {x_.at(fly) * per_q, y_.at(fly) * per_q, z_.at(fly) * per_q + projection_.height_m()};
}

}  // namespace flies
