#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/io/lens.hpp"

namespace flies::testing {

/// Two raw cameras of 640 x 480 px, 0.12 m apart, turned against each other.
struct ToyRig {
  cv::Matx33d m1{420, 0, 318, 0, 421, 243, 0, 0, 1}, m2{425, 0, 325, 0, 424, 236, 0, 0, 1};
  std::vector<double> d1{-0.28, 0.07, 0.0005, -0.0003, 0.0}, d2{-0.27, 0.06, -0.0002, 0.0004, 0.0};
  cv::Matx33d r;
  cv::Vec3d t{-0.12, 0.002, -0.003};
  Lens lens = Lens::brown;

  ToyRig() { cv::Rodrigues(cv::Vec3d(0.02, -0.03, 0.015), r); }

  static ToyRig fisheye() {
    ToyRig rig;
    rig.d1 = {-0.02, -0.007, 0.002, -0.001};
    rig.d2 = {-0.019, -0.005, -0.001, 0.0004};
    rig.lens = Lens::equidistant;
    return rig;
  }
  /// @param first the coefficients of both cameras
  static ToyRig of(Lens lens, std::vector<double> first, double focal_px) {
    ToyRig rig;
    rig.m1(0, 0) = rig.m1(1, 1) = rig.m2(0, 0) = rig.m2(1, 1) = focal_px;
    rig.d1 = rig.d2 = std::move(first);
    rig.lens = lens;
    return rig;
  }

  /// Where a point in the left camera's frame appears, by OpenCV where it has the model.
  cv::Point2d pixel(const cv::Point3d& point, bool in_right) const {
    const cv::Vec3d p = in_right ? r * cv::Vec3d(point) + t : cv::Vec3d(point);
    const auto& m = in_right ? m2 : m1;
    const auto& d = in_right ? d2 : d1;
    const std::vector<cv::Point3d> points{cv::Point3d(p)};
    std::vector<cv::Point2d> pixels;
    if (lens == Lens::brown) {
      cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), m, d, pixels);
    } else if (lens == Lens::equidistant) {
      cv::fisheye::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), m, d);
    } else {
      RawCamera camera{{m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), 0, 0, 1}, d, lens};
      const auto at = project(camera, {p[0], p[1], p[2]});
      pixels.emplace_back((*at)[0], (*at)[1]);
    }
    return pixels[0];
  }
};

/// Black, with a white dot.
inline GrayImage image_with_dot(cv::Point2d at, int width_px, int height_px) {
  GrayImage image{width_px, height_px,
                  std::vector<std::uint8_t>(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px))};
  constexpr double kRadius_px2 = 4.0;
  for (int v = 0; v < height_px; ++v)
    for (int u = 0; u < width_px; ++u)
      image.pixels[static_cast<std::size_t>(v * width_px + u)] = static_cast<std::uint8_t>(
          255 * std::exp(-(std::pow(u - at.x, 2) + std::pow(v - at.y, 2)) / (2 * kRadius_px2)));
  return image;
}

inline cv::Point2d centre_of_dot(const GrayImage& image) {
  double sum = 0, u_sum = 0, v_sum = 0;
  for (int v = 0; v < image.height_px; ++v)
    for (int u = 0; u < image.width_px; ++u) {
      const double level = image.view().at(u, v);
      sum += level;
      u_sum += level * u;
      v_sum += level * v;
    }
  return {u_sum / sum, v_sum / sum};
}

/// Dots at known points of space, seen by the raw cameras, must appear in the rectified images on one row and at the
/// disparity of their range.
inline void expect_rectifies(const Calibration& calibration, const ToyRig& rig) {
  ASSERT_TRUE(calibration.rectifier.has_value());
  const auto& camera = calibration.camera;
  for (const cv::Point3d point : {cv::Point3d(0, 0, 2), cv::Point3d(0.5, -0.35, 1.5), cv::Point3d(-0.5, 0.4, 2.5)}) {
    const GrayPair raw{image_with_dot(rig.pixel(point, false), camera.width_px, camera.height_px),
                       image_with_dot(rig.pixel(point, true), camera.width_px, camera.height_px), 8};
    const auto pair = calibration.rectifier->rectify(raw);
    const auto left = centre_of_dot(pair.left), right = centre_of_dot(pair.right);
    constexpr double kInterpolation_px = 0.15;  // remapping quantises to 1/32 px and the dot to 8 bits
    EXPECT_NEAR(left.y, right.y, kInterpolation_px) << point;
    // The rectified left camera is turned against the raw one, so the depth differs a little from point.z.
    const double depth_m = camera.fx_px * camera.baseline_m / (left.x - right.x);
    const double range_m =
        depth_m * std::hypot((left.x - camera.cx_px) / camera.fx_px, (left.y - camera.cy_px) / camera.fy_px, 1.0);
    constexpr double kRangeShare = 0.01;
    EXPECT_NEAR(range_m, cv::norm(point), kRangeShare * cv::norm(point)) << point;
  }
}

}  // namespace flies::testing
