#include "shared/camera_arguments.hpp"

#include <array>
#include <utility>

#include "shared/command_line.hpp"

void add_mount_options(CLI::App& command, CameraArguments& arguments) {
  command.add_option("--camera-height", arguments.height_m, "of the left camera above the road, metres")
      ->type_name("M");
  command.add_option("--camera-pitch", arguments.pitch_deg, "degrees, positive when it looks down")->type_name("DEG");
  command.add_option("--camera-roll", arguments.roll_deg, "degrees, positive when it leans to the right")
      ->type_name("DEG");
}

void add_raw_option(CLI::App& command, CameraArguments& arguments) {
  command.add_flag("--raw", arguments.is_raw,
                   "the images are as the cameras gave them: rectify them by the file, where it is of both kinds");
}

void add_resized_option(CLI::App& command, CameraArguments& arguments) {
  command.add_flag(
      "--resized", arguments.is_resized,
      "the images are whole ones, resized from the calibration's size, if not by the same across and down");
}

void add_baseline_option(CLI::App& command, CameraArguments& arguments) {
  command
      .add_option("--baseline", arguments.baseline_m,
                  "distance between the two cameras, metres: overrules the file, whose lengths may be in another unit")
      ->check(in_range(0.0001, 10000.0).description(""))
      ->type_name("M");
}

void add_calibrated_size_option(CLI::App& command, CameraArguments& arguments) {
  command
      .add_option(
          "--calib-size", arguments.calibrated_size_px,
          "image size that a calibration file without one, or with several, is for, where the images were resized")
      ->delimiter(',')
      ->expected(2)
      ->check(in_range(1, 100000).description(""))
      ->type_name("W,H");
}

void add_calibration_options(CLI::App& command, CameraArguments& arguments) {
  command.add_option("--right-calib", arguments.right_calib, "second file, where left and right have one each")
      ->type_name("FILE");
  add_raw_option(command, arguments);
  add_resized_option(command, arguments);
  add_baseline_option(command, arguments);
  add_calibrated_size_option(command, arguments);
}

void add_cameras_option(CLI::App& command, CameraArguments& arguments, const std::string& meaning) {
  command.add_option("--cameras", arguments.cameras, meaning)
      ->delimiter(',')
      ->expected(2)
      ->check(in_range(0, 255).description(""))
      ->type_name("L,R");
}

flies::CalibrationRequest calibration_request(const CameraArguments& arguments) {
  flies::CalibrationRequest request;
  fill_in(request, arguments);
  if (arguments.calibrated_size_px.size() == 2) {
    request.calibrated_width_px = arguments.calibrated_size_px[0];
    request.calibrated_height_px = arguments.calibrated_size_px[1];
  }
  request.right_path = arguments.right_calib;
  request.images_are_raw = arguments.is_raw;
  request.images_are_resized = arguments.is_resized;
  return request;
}

flies::CalibrationRequest calibration_request(const CameraArguments& arguments, const std::string& left_path,
                                              const std::string& right_path, const flies::RectifiedPair& images) {
  flies::CalibrationRequest request = calibration_request(arguments);
  if (const auto named = flies::kitti_cameras_from_paths(left_path, right_path)) request.default_cameras = *named;
  request.width_px = images.left.width_px;
  request.height_px = images.left.height_px;
  return request;
}

std::vector<std::string> named(const std::string& file, std::vector<std::string> notes) {
  for (auto& note : notes) note.insert(0, file + ": ");
  return notes;
}
