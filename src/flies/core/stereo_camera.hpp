#pragma once

#include <array>
#include <numbers>
#include <string>

#include "flies/core/road.hpp"

namespace flies {

constexpr double radians(double deg) { return deg * std::numbers::pi / 180.0; }
constexpr double degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

/// Where the left camera sits against the ground.
struct CameraMount {
  double height_m = 1.65;  ///< of the optical centre above the ground, > 0
  double pitch_rad = 0.0;  ///< positive: the camera looks down
  double roll_rad = 0.0;   ///< positive: the camera's left side is raised (it leans to the right)
};

/// A rectified stereo camera: two ideal pinholes with parallel axes, the right one displaced by the baseline.
struct StereoCamera {
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;        ///< principal point of the left image
  double cx_right_px = 0.0;  ///< principal point of the right image, mostly the same as `cx_px`; 0 is refused
  double cy_px = 0.0;        ///< shared by both images
  double baseline_m = 0.0;   ///< > 0, the right camera lies to the right of the left one
  int width_px = 0;          ///< of the images this calibration belongs to; 0 when the file does not say
  int height_px = 0;
  CameraMount mount;
};

/// Checks the ranges: focal lengths 0.01 to 1e6 px, of known images 0.1 to 20 widths, fx and fy at most a factor of 5
/// apart, baseline 0.005 to 10 m, height 1e-3 to 1e4 m, tilts within 45 degrees, sizes to 2^20 px or both 0, principal
/// points within one image size of the image, of unknown images within 2^20 px.
/// @throws InputError naming `source` and the field, and the likely unit where a length cannot be in the one expected
void check_camera(const StereoCamera& camera, const std::string& source);

/// Checks that the calibration fits images of this size.
/// @throws InputError naming `source` and both sizes
void check_camera_fits(const StereoCamera& camera, int width_px, int height_px, const std::string& source);

/// A point in the vehicle frame (ISO 8855): x forward, y left, z up, metres, origin on the ground below the left
/// camera. The nominal ground is z = 0.
struct Point3 {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
};

/// A point seen by both cameras: (u, v) in the left image, (u - disparity, v) in the right one.
struct StereoPoint {
  double u_px = 0.0;
  double v_px = 0.0;
  double disparity_px = 0.0;  ///< u_left - u_right, > 0 for points before infinity when both cx are equal
};

/// Projection between the vehicle frame and the two images (Li 2010, II.A, with pitch and
/// roll added). Built once for a camera; cheap to copy. Threads: constant after construction; any threads at once.
class Projection {
 public:
  explicit Projection(const StereoCamera& camera);

  /// Projects a point into both images. The depth along the optical axis must be positive: check with `depth_m`.
  StereoPoint project(const Point3& point_in_vehicle) const;

  /// Depth along the left camera's optical axis, metres; not positive behind the camera.
  double depth_m(const Point3& point_in_vehicle) const;

  /// The inverse of `project`. The disparity must exceed that of infinity (`cx_px - cx_right_px`).
  Point3 triangulate(const StereoPoint& point) const;

  /// Meets the line of sight through left pixel (u, v) with the road ahead.
  /// @returns a point with `x_m` <= 0 when it does not meet the road in front of the camera
  Point3 meet_road(double u_px, double v_px, const RoadPlane& road) const;

  /// Disparity, less that of infinity, at which the line of sight through left pixel (u, v) meets the road. Linear in u
  /// and v; 0 at the horizon and negative above it. With it, what is seen at a parallax p lies
  /// (1 - road_parallax_px / p) times the height of the camera above the road.
  double road_parallax_px(double u_px, double v_px, const RoadPlane& road) const;

  double disparity_at_depth(double depth_m) const { return fx_px_ * baseline_m_ / depth_m + disparity_offset_px_; }
  double depth_at_disparity(double disparity_px) const {
    return fx_px_ * baseline_m_ / (disparity_px - disparity_offset_px_);
  }
  /// Disparity of a point at infinity; 0 unless the principal points of the two images differ.
  double disparity_offset_px() const { return disparity_offset_px_; }
  double fx_px() const { return fx_px_; }
  double fy_px() const { return fy_px_; }
  double cy_px() const { return cy_px_; }
  double height_m() const { return height_m_; }  ///< of the camera above the nominal ground

 private:
  double fx_px_, fy_px_, cx_px_, cy_px_;
  double baseline_m_;
  double disparity_offset_px_;  ///< disparity of a point at infinity
  double height_m_;
  /// Rows: the camera's forward, left and up axes written in the vehicle frame.
  std::array<std::array<double, 3>, 3> camera_from_vehicle_;
};

/// Standard deviation of a range that was measured: of its disparity, and a share of the range for what the near face
/// of a thing is (measured: docs/cameras.md). It grows with the square of the range.
double range_deviation_m(const StereoCamera& camera, double range_m);

/// The inverse: the range at which the deviation is this share of the range; 0 when no range has so little.
double range_of_deviation_m(const StereoCamera& camera, double share);

}  // namespace flies
