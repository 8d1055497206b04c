#include "shared/camera_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "shared/command_line.hpp"

void add_mount_options(CLI::App& command, CameraArguments& arguments) {
  command.add_option("--camera-height", arguments.height_m, "height of the left camera above the road, metres")
      ->type_name("M");
  command
      .add_option("--camera-pitch", arguments.pitch_deg,
                  "pitch of the left camera, degrees, positive when it looks down")
      ->type_name("DEG");
  command
      .add_option("--camera-roll", arguments.roll_deg,
                  "roll of the left camera, degrees, positive when it leans to the right")
      ->type_name("DEG");
}

void add_raw_option(CLI::App& command, CameraArguments& arguments) {
  command.add_flag(
      "--raw", arguments.is_raw,
      "the images are raw, as the cameras gave them: rectify them; needed only where the calibration can be "
      "used for raw and for rectified images");
}

void add_resized_option(CLI::App& command, CameraArguments& arguments) {
  command.add_flag("--resized", arguments.is_resized,
                   "the images were resized from the calibration's size, not cropped; needed only where width and "
                   "height changed by different factors");
}

void add_baseline_option(CLI::App& command, CameraArguments& arguments) {
  command
      .add_option("--baseline", arguments.baseline_m,
                  "distance between the two cameras, metres; overrides the calibration file, e.g. where its lengths "
                  "are in another unit")
      ->check(in_range(0.0001, 10000.0).description(""))
      ->type_name("M");
}

void add_disparity_shift_option(CLI::App& command, CameraArguments& arguments) {
  command
      .add_option(
          "--disparity-shift", arguments.disparity_shift_px,
          "pixels added to every disparity, to correct cameras that are turned against each other by what `flies "
          "check`, `track` or `live` reported")
      ->check(in_range(-10000.0, 10000.0).description(""))
      ->type_name("PX");
}

void add_calibrated_size_option(CLI::App& command, CameraArguments& arguments) {
  command
      .add_option("--calib-size", arguments.calibrated_size_px,
                  "image size that the calibration is for; needed only for resized images, where the file gives no "
                  "size or several")
      ->delimiter(',')
      ->expected(2)
      ->check(in_range(1, 100000).description(""))
      ->type_name("W,H");
}

void add_calibration_options(CLI::App& command, CameraArguments& arguments) {
  command
      .add_option("--right-calib", arguments.right_calib,
                  "second calibration file, where left and right camera have one each")
      ->type_name("FILE");
  add_raw_option(command, arguments);
  add_resized_option(command, arguments);
  add_baseline_option(command, arguments);
  add_disparity_shift_option(command, arguments);
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
  flies::ask_for_images(request, images);
  return request;
}

namespace {

/// Where the cameras that are asked for are not those that the paths of the images name.
std::optional<flies::CalibrationNote> doubt_on_cameras(const CameraArguments& arguments, const std::string& format,
                                                       const std::string& left_path, const std::string& right_path) {
  if (arguments.cameras.empty() || !format.starts_with("KITTI")) return std::nullopt;
  const auto in_paths = flies::kitti_cameras_from_paths(left_path, right_path);
  if (!in_paths || std::ranges::equal(*in_paths, arguments.cameras)) return std::nullopt;
  return flies::CalibrationNote{
      fmt::format("--cameras {},{} is used, but the paths of the images name the cameras {} and {}: if the images are "
                  "of these, ranges are wrong; leave --cameras out",
                  arguments.cameras[0], arguments.cameras[1], (*in_paths)[0], (*in_paths)[1])};
}

}  // namespace

flies::Calibration calibration_for(const std::string& calib, const CameraArguments& arguments,
                                   const std::string& left_path, const std::string& right_path,
                                   const flies::RectifiedPair& images) {
  auto calibration = flies::load_calibration(calib, calibration_request(arguments, left_path, right_path, images));
  if (auto doubt = doubt_on_cameras(arguments, calibration.format, left_path, right_path))
    calibration.notes.push_back(*std::move(doubt));
  return calibration;
}

std::vector<std::string> named(const std::string& file, std::vector<std::string> notes) {
  for (auto& note : notes) note.insert(0, file + ": ");
  return notes;
}
