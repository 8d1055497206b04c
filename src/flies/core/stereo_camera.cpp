#include "flies/core/stereo_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flies/core/error.hpp"
#include "flies/core/plausible.hpp"

namespace flies {
namespace {

/// What numbers can bear; `check_plausible` draws narrower bounds round what cameras have.
constexpr double kLeastFocal_px = 0.01, kMostFocal_px = 1e6;
constexpr double kLeastBaseline_m = 1e-4, kMostBaseline_m = 1e4;
constexpr int kMostSize_px = 1 << 20;

/// Standard deviations of the disparity of an obstacle, and of its range where disparity is exact, as a share of it.
constexpr double kDisparityDeviation_px = 0.3;
constexpr double kRangeDeviation = 0.015;

void require(bool ok, const std::string& source, const char* field, double found, const char* allowed) {
  if (!ok) throw InputError(source, field, fmt::format("found {:.6g}, expected {}", found, allowed));
}

}  // namespace

void check_camera(const StereoCamera& camera, const std::string& source) {
  const auto require_within = [&](double value, double least, double most, const char* field, const char* hint = "") {
    if (!(value >= least && value <= most))
      throw InputError(source, field, fmt::format("found {:.6g}, expected {:g} to {:g}{}", value, least, most, hint));
  };
  require_within(camera.fx_px, kLeastFocal_px, kMostFocal_px, "fx_px (focal length)");
  require_within(camera.fy_px, kLeastFocal_px, kMostFocal_px, "fy_px (focal length)");
  require_within(camera.width_px, 0, kMostSize_px, "width_px (image size)");
  require_within(camera.height_px, 0, kMostSize_px, "height_px (image size)");
  if ((camera.width_px == 0) != (camera.height_px == 0))
    throw InputError(source, "image size",
                     fmt::format("found {} x {} px, expected both or, where it is not known, neither", camera.width_px,
                                 camera.height_px));
  require_within(camera.cx_px, -kMostSize_px, kMostSize_px, "cx_px (principal point)");
  require_within(camera.cx_right_px, -kMostSize_px, kMostSize_px, "cx_right_px (principal point of the right image)");
  if (camera.cx_right_px == 0.0 && std::abs(camera.cx_px) > 1.0)
    throw InputError(
        source, "cx_right_px (principal point of the right image)",
        fmt::format("found 0, as if it was not set; it is usually the same as cx_px, {:.6g}", camera.cx_px));
  require_within(camera.cy_px, -kMostSize_px, kMostSize_px, "cy_px (principal point)");
  require_within(camera.baseline_m, kLeastBaseline_m, kMostBaseline_m, "baseline_m",
                 camera.baseline_m < 0.0 ? " (a negative baseline means that left and right are swapped)" : "");
  detail::check_mount(camera.mount, source);
  if (camera.width_px > 0 && camera.height_px > 0) {
    const auto require_near = [&](double value, int size_px, const char* field) {
      require(value >= -size_px && value <= 2.0 * size_px, source, field, value,
              "a value within one image size of the image");
    };
    require_near(camera.cx_px, camera.width_px, "cx_px (principal point)");
    require_near(camera.cx_right_px, camera.width_px, "cx_right_px (principal point of the right image)");
    require_near(camera.cy_px, camera.height_px, "cy_px (principal point)");
  }
  detail::check_plausible(camera, source);  // its notes are for who reads files
}

void check_camera_fits(const StereoCamera& camera, int width_px, int height_px, const std::string& source) {
  if (camera.width_px > 0 && camera.height_px > 0) {
    if (camera.width_px == height_px && camera.height_px == width_px && width_px != height_px)
      throw InputError(source, "image size",
                       fmt::format("the calibration is for {} x {} px, the images have {} x {} px: are they turned by "
                                   "90 degrees? (Their EXIF orientation is already applied.)",
                                   camera.width_px, camera.height_px, width_px, height_px));
    if (width_px >= camera.width_px && height_px >= camera.height_px &&
        width_px + height_px > camera.width_px + camera.height_px)
      throw InputError(
          source, "image size",
          fmt::format("the calibration is for {} x {} px, the images have {} x {} px: were they padded by {} columns "
                      "and {} rows, or letterboxed (then cut that off)? If nothing was added, they were resized by "
                      "{:.3g} horizontally and {:.3g} vertically (then give --resized)",
                      camera.width_px, camera.height_px, width_px, height_px, width_px - camera.width_px,
                      height_px - camera.height_px, static_cast<double>(width_px) / camera.width_px,
                      static_cast<double>(height_px) / camera.height_px));
    if (camera.width_px != width_px || camera.height_px != height_px)
      throw InputError(source, "image size",
                       fmt::format("the calibration is for {} x {} px, the images have {} x {} px: were they resized "
                                   "by {:.3g} horizontally and {:.3g} vertically (then give --resized), letterboxed "
                                   "(then cut the borders off), or cropped? Then subtract the columns and rows cut off "
                                   "at the left and at the top from cx and cy, and give the size of the images",
                                   camera.width_px, camera.height_px, width_px, height_px,
                                   static_cast<double>(width_px) / camera.width_px,
                                   static_cast<double>(height_px) / camera.height_px));
    return;
  }
  // A file without a size still betrays itself: the principal point of a real camera lies well inside its image.
  const auto require_inside = [&](double centre_px, int size_px, const char* field) {
    if (centre_px < 0.0 || centre_px > size_px)
      throw InputError(source, field,
                       fmt::format("found {:.1f}, outside the images of {} x {} px: the calibration is for images of "
                                   "another size",
                                   centre_px, width_px, height_px));
  };
  require_inside(camera.cx_px, width_px, "cx_px (principal point)");
  require_inside(camera.cy_px, height_px, "cy_px (principal point)");
}

Projection::Projection(const StereoCamera& camera)
    : fx_px_(camera.fx_px),
      fy_px_(camera.fy_px),
      cx_px_(camera.cx_px),
      cy_px_(camera.cy_px),
      baseline_m_(camera.baseline_m),
      disparity_offset_px_(camera.cx_px - camera.cx_right_px),
      height_m_(camera.mount.height_m) {
  // vehicle_from_camera = Ry(pitch) * Rx(roll): both right-handed about the vehicle's y (left) and x (forward) axes,
  // so that a positive pitch turns the optical axis down and a positive roll raises the left side.
  const double cp = std::cos(camera.mount.pitch_rad), sp = std::sin(camera.mount.pitch_rad);
  const double cr = std::cos(camera.mount.roll_rad), sr = std::sin(camera.mount.roll_rad);
  camera_from_vehicle_ = {{{cp, 0.0, -sp}, {sp * sr, cr, cp * sr}, {sp * cr, -sr, cp * cr}}};
}

double Projection::depth_m(const Point3& p) const {
  const auto& forward = camera_from_vehicle_[0];
  return forward[0] * p.x_m + forward[1] * p.y_m + forward[2] * (p.z_m - height_m_);
}

StereoPoint Projection::project(const Point3& p) const {
  const double z_m = p.z_m - height_m_;
  const auto& [forward, left, up] = camera_from_vehicle_;
  const double depth = forward[0] * p.x_m + forward[1] * p.y_m + forward[2] * z_m;
  const double left_m = left[0] * p.x_m + left[1] * p.y_m + left[2] * z_m;
  const double up_m = up[0] * p.x_m + up[1] * p.y_m + up[2] * z_m;
  return {cx_px_ - fx_px_ * left_m / depth, cy_px_ - fy_px_ * up_m / depth, disparity_at_depth(depth)};
}

Point3 Projection::triangulate(const StereoPoint& point) const {
  const double depth = depth_at_disparity(point.disparity_px);
  const double left_m = (cx_px_ - point.u_px) / fx_px_ * depth;
  const double up_m = (cy_px_ - point.v_px) / fy_px_ * depth;
  const auto& m = camera_from_vehicle_;
  return {m[0][0] * depth + m[1][0] * left_m + m[2][0] * up_m, m[0][1] * depth + m[1][1] * left_m + m[2][1] * up_m,
          m[0][2] * depth + m[1][2] * left_m + m[2][2] * up_m + height_m_};
}

double Projection::road_parallax_px(double u_px, double v_px, const RoadPlane& road) const {
  const double left = (cx_px_ - u_px) / fx_px_;
  const double up = (cy_px_ - v_px) / fy_px_;
  const auto& m = camera_from_vehicle_;
  const double x = m[0][0] + m[1][0] * left + m[2][0] * up;
  const double y = m[0][1] + m[1][1] * left + m[2][1] * up;
  const double z = m[0][2] + m[1][2] * left + m[2][2] * up;
  // One over the depth at which `meet_road` meets it.
  return fx_px_ * baseline_m_ * (z - road.slope * x - road.bank * y) / (road.height_m - height_m_);
}

Point3 Projection::meet_road(double u_px, double v_px, const RoadPlane& road) const {
  const double left = (cx_px_ - u_px) / fx_px_;
  const double up = (cy_px_ - v_px) / fy_px_;
  const auto& m = camera_from_vehicle_;
  const double x = m[0][0] + m[1][0] * left + m[2][0] * up;
  const double y = m[0][1] + m[1][1] * left + m[2][1] * up;
  const double z = m[0][2] + m[1][2] * left + m[2][2] * up;
  // Camera centre (0, 0, h) plus depth * (x, y, z) on the plane z = height + slope x + bank y.
  const double depth = (road.height_m - height_m_) / (z - road.slope * x - road.bank * y);
  if (!(depth > 0.0) || !std::isfinite(depth)) return {};
  return {x * depth, y * depth, height_m_ + z * depth};
}

double range_deviation_m(const StereoCamera& camera, double range_m) {
  const double by_disparity = kDisparityDeviation_px * range_m / (camera.fx_px * camera.baseline_m);
  return range_m * std::hypot(by_disparity, kRangeDeviation);
}

double range_of_deviation_m(const StereoCamera& camera, double share) {
  const double by_disparity = std::sqrt(std::max(0.0, share * share - kRangeDeviation * kRangeDeviation));
  return by_disparity * camera.fx_px * camera.baseline_m / kDisparityDeviation_px;
}

}  // namespace flies
