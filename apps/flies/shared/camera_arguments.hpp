#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/io/calibration.hpp"

/// What the user says of the camera beside its calibration file.
struct CameraArguments {
  std::vector<int> cameras;             ///< KITTI's, left and right; empty: not said
  std::vector<int> calibrated_size_px;  ///< width and height that a file without a size is for; empty: not said
  std::string right_calib;              ///< second file, where left and right have one each
  bool is_raw = false;                  ///< the images are as the cameras gave them
  bool is_resized = false;              ///< by any two scales from the size that the file is for
  std::optional<double> baseline_m;     ///< overrules the file's
  double disparity_shift_px = 0.0;      ///< added to every disparity
  std::optional<double> height_m, pitch_deg, roll_deg;
};

void add_mount_options(CLI::App& command, CameraArguments& arguments);

/// What is to be said beside `--calib FILE`: --right-calib, --calib-size, --raw, --resized, --baseline,
/// --disparity-shift.
void add_calibration_options(CLI::App& command, CameraArguments& arguments);

void add_raw_option(CLI::App& command, CameraArguments& arguments);
void add_resized_option(CLI::App& command, CameraArguments& arguments);
void add_baseline_option(CLI::App& command, CameraArguments& arguments);
void add_disparity_shift_option(CLI::App& command, CameraArguments& arguments);
void add_calibrated_size_option(CLI::App& command, CameraArguments& arguments);  ///< --calib-size

/// @param meaning what `--cameras` does for this command
void add_cameras_option(CLI::App& command, CameraArguments& arguments, const std::string& meaning);

/// @param request a flies::CalibrationRequest or flies::DatasetRequest
template <class Request>
void fill_in(Request& request, const CameraArguments& arguments) {
  if (!arguments.cameras.empty()) request.cameras = std::array{arguments.cameras[0], arguments.cameras[1]};
  request.baseline_m = arguments.baseline_m;
  request.disparity_shift_px = arguments.disparity_shift_px;
  request.camera_height_m = arguments.height_m;
  if (arguments.pitch_deg) request.camera_pitch_rad = flies::radians(*arguments.pitch_deg);
  if (arguments.roll_deg) request.camera_roll_rad = flies::radians(*arguments.roll_deg);
}

/// A calibration for images that are not known.
flies::CalibrationRequest calibration_request(const CameraArguments& arguments);

/// A calibration for a pair of images, whose paths tell which KITTI cameras they come from.
flies::CalibrationRequest calibration_request(const CameraArguments& arguments, const std::string& left_path,
                                              const std::string& right_path, const flies::RectifiedPair& images);

/// Reads it.
/// @throws flies::InputError as `flies::load_calibration` does
flies::Calibration calibration_for(const std::string& calib, const CameraArguments& arguments,
                                   const std::string& left_path, const std::string& right_path,
                                   const flies::RectifiedPair& images);

/// Sentences on a file, each with its name before it.
std::vector<std::string> named(const std::string& file, std::vector<std::string> notes);
