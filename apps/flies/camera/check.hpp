#pragma once

#include <string>

#include "shared/camera_arguments.hpp"
#include "shared/pair_arguments.hpp"

struct CheckArguments {
  PairArguments images;
  std::string calib, picture;
  CameraArguments camera;
  bool json = false;
};

/// Prints what is told of images and calibration.
void run_check(const CheckArguments& arguments);

/// Whether the calibration still fits the rig that took these images, in words.
/// @throws flies::InputError as `detect` does
std::string fit_of_rig(const CheckArguments& arguments);
