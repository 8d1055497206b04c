#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "flies/core/stereo_camera.hpp"

namespace flies::testing {

inline constexpr double kBoxX_m = 10.0;
inline constexpr double kBoxY_m = 1.0;

/// A camera of 320 x 240 px, 1.65 m above a level road.
StereoCamera street_camera();

/// Two CV_8UC1 views of a textured road with a textured box, 1.6 m wide and 1.8 m high, its face `kBoxX_m` ahead and
/// `kBoxY_m` to the left, before a wall 28 m ahead.
struct StreetPair {
  cv::Mat left, right;
};
const StreetPair& street_pair();

/// A picture of something else: the same kind of texture, without relation to the street.
cv::Mat unrelated_picture();

/// A KITTI object calibration with these values for cameras 2 and 3; it holds neither size nor camera height.
std::string kitti_calibration(double focal_px, double centre_u_px, double baseline_m);
std::string kitti_calibration();

/// Writes left.png, right.png and calib.txt.
void write_street(const std::filesystem::path& folder);

}  // namespace flies::testing
