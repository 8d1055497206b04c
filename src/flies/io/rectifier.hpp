#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/io/gray_image.hpp"

namespace flies {

/// A calibrated but not rectified stereo camera, as OpenCV's stereoCalibrate leaves it.
struct RawStereo {
  int width_px = 0;
  int height_px = 0;
  std::array<double, 9> left_intrinsics{}, right_intrinsics{};  ///< M1, M2: 3 x 3, row by row, pixels
  std::vector<double> left_distortion, right_distortion;        ///< D1, D2: 4, 5, 8, 12 or 14 coefficients
  std::array<double, 9> rotation{};                             ///< R: right_from_left, 3 x 3, row by row
  bool is_fisheye = false;  ///< OpenCV's fisheye (equidistant) model with 4 coefficients; otherwise its pinhole one
  std::array<double, 3> translation_m{};  ///< T: right_from_left; its x is negative when the right camera is right
};

/// Turns raw pairs into rectified ones: computes the rectification once, then remaps pair after pair. Rotations keep
/// infinity at disparity 0 and the images are scaled so that only valid pixels are seen. Threads: any number at once.
class Rectifier {
 public:
  /// @param source names the calibration in errors
  /// @throws InputError when the numbers give no side-by-side stereo camera
  Rectifier(const RawStereo& raw, const std::string& source);

  /// The rectified camera; its mount is the default one.
  const StereoCamera& camera() const { return camera_; }

  /// @throws InputError naming `source` when the images have another size than the calibration
  GrayPair rectify(const GrayPair& raw_pair) const;

 private:
  struct Maps;
  StereoCamera camera_;
  std::string source_;
  std::shared_ptr<const Maps> maps_;
};

}  // namespace flies
