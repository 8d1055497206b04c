// Calibrations as files of other programs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/calibration.hpp"

namespace flies {
namespace {

constexpr std::array<double, 9> kUpright{1, 0, 0, 0, 1, 0, 0, 0, 1};

/// K [I | t] of the left or right rectified camera, row by row.
std::array<double, 12> projection(const StereoCamera& camera, bool is_right) {
  const double shift = is_right ? -camera.fx_px * camera.baseline_m : 0.0;
  return {camera.fx_px,
          0,
          is_right ? camera.cx_right_px : camera.cx_px,
          shift,
          0,
          camera.fy_px,
          camera.cy_px,
          0,
          0,
          0,
          1,
          0};
}

/// The camera without its last column.
std::array<double, 9> matrix(const StereoCamera& camera, bool is_right) {
  return {camera.fx_px, 0, is_right ? camera.cx_right_px : camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
}

const char* model_name(const RawCamera& camera, const char* format, const std::string& source) {
  constexpr std::size_t kMostOfPlumbBob = 5;
  if (camera.lens == Lens::equidistant) return "equidistant";
  if (camera.lens == Lens::brown)
    return camera.distortion.size() > kMostOfPlumbBob ? "rational_polynomial" : "plumb_bob";
  throw InputError(source, "lens",
                   fmt::format("is of the {} model, which {} does not have", lens_name(camera.lens), format));
}

std::string kitti(const StereoCamera& camera) {
  const auto row = [&](int number, bool is_right) {
    return fmt::format("P{}: {}\n", number, fmt::join(projection(camera, is_right), " "));
  };
  return row(0, false) + row(1, true) + row(2, false) + row(3, true) + "R0_rect: 1 0 0 0 1 0 0 0 1\n";
}

template <class Values>
std::string opencv_matrix(const char* key, int rows, const Values& values) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n", key, rows,
                     values.size() / static_cast<std::size_t>(rows), fmt::join(values, ", "));
}

std::string opencv(const Calibration& calibration, const std::string& source) {
  const auto& camera = calibration.camera;
  std::string text = "%YAML:1.0\n---\n";
  if (camera.width_px > 0)
    text += fmt::format("image_width: {}\nimage_height: {}\n", camera.width_px, camera.height_px);
  if (!calibration.rectifier)
    return text + opencv_matrix("P1", 3, projection(camera, false)) + opencv_matrix("P2", 3, projection(camera, true));
  const auto& raw = calibration.rectifier->raw();
  text += fmt::format("distortion_model: {}\n", model_name(raw.left, "OpenCV", source));
  return text + opencv_matrix("M1", 3, raw.left.matrix) + opencv_matrix("D1", 1, raw.left.distortion) +
         opencv_matrix("M2", 3, raw.right.matrix) + opencv_matrix("D2", 1, raw.right.distortion) +
         opencv_matrix("R", 3, raw.rotation) + opencv_matrix("T", 3, raw.translation_m);
}

template <class Values>
std::string ros_matrix(const char* key, int rows, const Values& values) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", key, rows,
                     values.size() / static_cast<std::size_t>(rows), fmt::join(values, ", "));
}

std::string ros(const Calibration& calibration, bool is_right, const std::string& source) {
  const auto& camera = calibration.camera;
  const auto& rectifier = calibration.rectifier;
  RawCamera raw{matrix(camera, is_right), {0, 0, 0, 0, 0}, Lens::brown};
  auto rotation = kUpright;
  if (rectifier) {
    raw = is_right ? rectifier->raw().right : rectifier->raw().left;
    rotation = is_right ? rectifier->right_rotation() : rectifier->left_rotation();
  }
  return fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n", camera.width_px, camera.height_px,
                     is_right ? "right" : "left") +
         ros_matrix("camera_matrix", 3, raw.matrix) +
         fmt::format("distortion_model: {}\n", model_name(raw, "ROS", source)) +
         ros_matrix("distortion_coefficients", 1, raw.distortion) + ros_matrix("rectification_matrix", 3, rotation) +
         ros_matrix("projection_matrix", 3, projection(camera, is_right));
}

}  // namespace

CalibrationTexts calibration_texts(const Calibration& calibration, CalibrationSyntax syntax,
                                   const std::string& source) {
  const bool holds_raw = syntax == CalibrationSyntax::opencv || syntax == CalibrationSyntax::ros;
  if (calibration.rectifier && !holds_raw)
    throw InputError(source, "format",
                     "is of raw images, but KITTI and the YAML of flies are of rectified ones; allowed: opencv, ros");
  const bool holds_size = syntax == CalibrationSyntax::ros || syntax == CalibrationSyntax::yaml;
  if (holds_size && calibration.camera.width_px == 0)
    throw InputError(source, "image size", "is missing, but ROS and the YAML of flies need it; give it with --size");
  switch (syntax) {
    case CalibrationSyntax::kitti:
      return {kitti(calibration.camera), ""};
    case CalibrationSyntax::opencv:
      return {opencv(calibration, source), ""};
    case CalibrationSyntax::ros:
      return {ros(calibration, false, source), ros(calibration, true, source)};
    case CalibrationSyntax::yaml:
      break;
  }
  return {calibration_yaml(calibration.camera), ""};
}

}  // namespace flies
