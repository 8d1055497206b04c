#pragma once

#include <array>
#include <memory>
#include <string>

#include "flies/core/stereo_camera.hpp"
#include "flies/io/gray_image.hpp"
#include "flies/io/lens.hpp"

namespace flies {

/// A calibrated but not rectified stereo camera.
struct RawStereo {
  int width_px = 0;
  int height_px = 0;
  RawCamera left, right;
  std::array<double, 9> rotation{};       ///< right_from_left, 3 x 3, row by row; OpenCV's R
  std::array<double, 3> translation_m{};  ///< right_from_left; its x is negative when the right camera is right. T
};

/// The least focal length of rectified images over their width: 127 degrees across. What lies farther to the side would
/// take nearly all pixels.
inline constexpr double kWidestRectified = 0.25;

/// Turns raw pairs into rectified ones: computes the rectification once, then remaps pair after pair. Rotations keep
/// infinity at disparity 0 and the images are scaled so that only valid pixels are seen. Threads: any number at once.
/// One that was moved from may be assigned to and destroyed; `rectify` throws std::logic_error.
class Rectifier {
 public:
  /// @param source names the calibration in errors
  /// @throws InputError when the numbers give no side-by-side stereo camera
  Rectifier(const RawStereo& raw, const std::string& source);

  /// The rectified camera; its mount is the default one.
  const StereoCamera& camera() const { return camera_; }

  const RawStereo& raw() const { return raw_; }
  /// Rectified left (right) frame from raw left (right) frame, 3 x 3, row by row; OpenCV's R1 and R2.
  const std::array<double, 9>& left_rotation() const { return left_rotation_; }
  const std::array<double, 9>& right_rotation() const { return right_rotation_; }

  /// @throws InputError naming `source` when the images have another size than the calibration
  GrayPair rectify(const GrayPair& raw_pair) const;

 private:
  struct Maps;
  RawStereo raw_;
  StereoCamera camera_;
  std::array<double, 9> left_rotation_{}, right_rotation_{};
  std::string source_;
  std::shared_ptr<const Maps> maps_;
};

}  // namespace flies
