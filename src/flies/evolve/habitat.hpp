#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "flies/core/field.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// Where flies may live: in the field of detection and in the left image. Flies are places in the image here. Their
/// coordinates in the vehicle frame are linear in (u, v), once multiplied by the nearness q = disparity minus that of
/// infinity (Li 2010, II.A, solved for the point), so that a test costs no division.
class Habitat {
 public:
  Habitat(const Projection& projection, const RectifiedPair& pair, const RoadPlane& road, const FieldOptions& field);

  /// True when the fly lies in the field and its left projection in the image; false when it is not finite.
  bool holds(const StereoPoint& fly) const {
    const double q = fly.disparity_px - projection_.disparity_offset_px();
    const auto between = [](double low, double value, double high) { return (value >= low) & (value <= high); };
    return (q > 0.0) & between(0.0, fly.u_px, left().width_px - 1) & between(0.0, fly.v_px, left().height_px - 1) &
           between(field_.x_min_m * q, x_.at(fly), field_.x_max_m * q) &
           between(field_.y_min_m * q, y_.at(fly), field_.y_max_m * q) &
           between((field_.z_min_m - camera_above_road_m_) * q, height_.at(fly),
                   (field_.z_max_m - camera_above_road_m_) * q);
  }

  /// The fly in this column and of this disparity that is `height_m` above the road.
  StereoPoint at_height(double u_px, double height_m, double disparity_px) const;

  /// Disparities at equal ratios: from that of the far end of the field (0) to that of its near end (1). Looked up and
  /// interpolated, within 2e-5 of its logarithm.
  double disparity_at_ratio(double ratio) const {
    const double place = ratio * kSteps;
    const auto step = static_cast<std::size_t>(place);
    const double below = q_at_ratios_[step], above = q_at_ratios_[step + 1];
    return projection_.disparity_offset_px() + below + (place - static_cast<double>(step)) * (above - below);
  }

  /// Between which nearnesses q > 0 a fly may be at this place of the left image; the least is not below the most when
  /// it may be nowhere.
  struct Sight {
    double least_q_px = 0.0, most_q_px = 0.0;
  };
  Sight sight(double u_px, double v_px) const;

  /// Steps of the table behind `disparity_at_ratio`; it has an entry more on either side of the last step.
  static constexpr std::size_t kSteps = 256;
  const std::array<float, kSteps + 2>& q_at_ratios() const { return q_at_ratios_; }

  /// Position in the vehicle frame. The fly's disparity must exceed that of infinity.
  Point3 point(const StereoPoint& fly) const {
    const double per_q = 1.0 / (fly.disparity_px - projection_.disparity_offset_px());
    return {x_.at(fly) * per_q, y_.at(fly) * per_q, z_.at(fly) * per_q + projection_.height_m()};
  }

  /// A coordinate relative to the camera, times q, in metres times pixels.
  struct Linear {
    double constant = 0.0, per_u = 0.0, per_v = 0.0;
    double at(const StereoPoint& fly) const { return constant + per_u * fly.u_px + per_v * fly.v_px; }
  };

  /// Some nearnesses, each linear in the place and divided by the bound of a coordinate.
  class Bounds {
   public:
    void add(const Linear& bound) { bounds_[count_++] = bound; }
    std::span<const Linear> all() const { return std::span(bounds_).first(count_); }

   private:
    std::array<Linear, 7> bounds_;  // one of its own, and two for each of three coordinates
    std::size_t count_ = 0;
  };

  /// What q is not below and not above at a place; `sight` is the strictest of each.
  std::span<const Linear> least_q() const { return least_q_.all(); }
  std::span<const Linear> most_q() const { return most_q_.all(); }

  const Linear& x() const { return x_; }            ///< forward
  const Linear& y() const { return y_; }            ///< to the left
  const Linear& height() const { return height_; }  ///< along the vertical, above the road's slope through the camera
  double camera_above_road_m() const { return camera_above_road_m_; }

  const Projection& projection() const { return projection_; }
  const GrayView& left() const { return pair_.left; }
  const RectifiedPair& pair() const { return pair_; }
  const RoadPlane& road() const { return road_; }
  const FieldOptions& field() const { return field_; }

 private:
  Projection projection_;
  RectifiedPair pair_;
  RoadPlane road_;
  FieldOptions field_;
  Linear x_, y_, z_, height_;
  double camera_above_road_m_;
  double far_q_px_, near_q_px_;
  std::array<float, kSteps + 2> q_at_ratios_;
  Bounds least_q_, most_q_;
};

}  // namespace flies
