// What every example begins with: a stereo pair and its calibration, from files to something to work on.
#pragma once

#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"

struct Input {
  flies::GrayPair images;  // 8-bit grey, rectified; `images.view()` is what the library works on
  flies::StereoCamera camera;
};

/// @throws flies::InputError as one line that says what is wrong with which file
inline Input load_input(const char* left, const char* right, const char* calib) {
  flies::GrayPair images = flies::load_pair(left, right);
  // The calibration is told the images, for not every format states their size, and which of KITTI's four cameras.
  flies::CalibrationRequest request;
  request.cameras = flies::kitti_cameras_from_paths(left, right);
  flies::ask_for_images(request, images.view());
  const flies::Calibration calibration = flies::load_calibration(calib, request);
  if (calibration.rectifier) images = calibration.rectifier->rectify(images);
  return {images, calibration.camera};
}
