#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flies/io/calibration_formats.hpp"
#include "flies/io/formats/lens_names.hpp"
#include "flies/io/formats/pose_reading.hpp"
#include "flies/io/rectifier.hpp"

namespace flies::detail {

/// Two raw cameras and the keys that they were read from, which name them in errors and notes.
struct RawPair {
  RawStereo stereo;
  std::string left_key, right_key;  ///< "cam0", "M1", ...
  std::string pose_key;             ///< "T_cn_cnm1", "R", ...
  CalibrationNotes notes = {};      ///< on how they were read
  /// Those of the coefficients of left and right; empty where they are below the keys above.
  std::array<std::string, 2> distortion_keys = {};
  /// body_from_left and body_from_right, of files that say where both cameras stand in a frame of something else.
  std::optional<std::array<Pose, 2>> body_poses = {};

  const std::string& left_distortion() const { return distortion_keys[0].empty() ? left_key : distortion_keys[0]; }
  const std::string& right_distortion() const { return distortion_keys[1].empty() ? right_key : distortion_keys[1]; }
};

/// The camera that sees the rectified images, and what rectifies them; scaled to the images that are asked for.
/// @param pair with 0 x 0 where the file has no size: it is that which the user says, which the principal point tells,
///             or that of the images
/// @throws InputError when matrix, distortion or pose cannot be, when the lenses differ, or when no size is known
Calibration calibration_from_raw(RawPair pair, const CalibrationRequest& request, const std::string& source);

/// The same of a file that does not say whether its images are rectified: they are where neither lens bends anything
/// and the cameras look the same way side by side, as with a camera that rectifies them itself.
Calibration calibration_from_pair(RawPair pair, const CalibrationRequest& request, const std::string& source);

/// Whether a shift from camera to camera is written in millimetres where no unit is named: no two cameras stand 10 m
/// apart, or 10 mm. Three numbers.
bool are_millimetres(std::span<const double> translation);

/// Sets rotation and translation of the right camera.
void set_pose(RawStereo& stereo, const Pose& right_from_left);

/// The same by where both cameras stand in the frame of a body.
void set_body_poses(RawPair& pair, const Pose& body_from_left, const Pose& body_from_right);

/// fx, fy, cx, cy as a camera matrix.
std::array<double, 9> camera_matrix(double fx_px, double fy_px, double cx_px, double cy_px);

/// 3 x 3 numbers of a key.
std::array<double, 9> matrix_of(const NumberTable& table, const std::string& key);

/// Coefficients that files write one a key: `prefix` + "k1", ...; missing ones at the end are left out, others are 0.
/// None where the file has none of them.
/// @param least that there are, as lenses that are only radial may have k1 and k2 alone
std::vector<double> coefficients_of(const NumberTable& table, const std::string& prefix,
                                    std::initializer_list<const char*> names, std::size_t least = 4);

/// The size in `width` and `height`, or nothing, 0 x 0, when the file has neither.
struct ImageSize {
  int width_px = 0, height_px = 0;
};
/// Of a list: width, height; or the shape of a NumPy array: height, width, 1, 3 or 4.
ImageSize size_of_list(const NumberTable& table, const std::string& key);

/// @throws InputError when the right camera's size, found in `source` at `key`, is not that of the left one
void check_same_size(ImageSize left, ImageSize right, const std::string& source, const std::string& key);

/// What ROS and ORB-SLAM write of a raw camera: how it is rectified.
struct RectifiedView {
  RawCamera camera;
  std::array<double, 9> rotation{};  ///< rectified from raw
  std::vector<double> projection;    ///< 3 x 4
};
/// right_from_left of two cameras that were rectified so.
Pose pose_of_views(const RectifiedView& left, const RectifiedView& right);

}  // namespace flies::detail
