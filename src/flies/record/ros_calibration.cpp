#include "flies/record/ros_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flies/core/error.hpp"
#include "flies/io/calibration_formats.hpp"

namespace flies {
namespace {

using Matrix = std::array<double, 9>;

Matrix transposed(const Matrix& m) { return {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}; }

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix result{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      for (std::size_t k = 0; k < 3; ++k) result[3 * row + column] += a[3 * row + k] * b[3 * k + column];
  return result;
}

double baseline_m(const RosCameraInfo& right, const std::string& source) {
  const double baseline = -right.projection[3] / right.projection[0];
  if (!std::isfinite(baseline) || !(baseline > 0))
    throw InputError(source, "P of the right camera",
                     fmt::format("gives a baseline of {} m, expected more than 0: the fourth number is minus focal "
                                 "length times baseline; are left and right swapped?",
                                 baseline));
  return baseline;
}

RawCamera raw_camera(const RosCameraInfo& camera, const std::string& source) {
  const auto& model = camera.distortion_model;
  if (model == "equidistant" || model == "fisheye") return {camera.intrinsics, camera.distortion, Lens::equidistant};
  if (model.empty() || model == "plumb_bob" || model == "rational_polynomial")
    return {camera.intrinsics, camera.distortion, Lens::brown};
  throw InputError(source, "distortion_model",
                   fmt::format("found '{}', expected plumb_bob, rational_polynomial or equidistant", model));
}

RawStereo raw_stereo(const RosCameraInfo& left, const RosCameraInfo& right, const std::string& source) {
  RawStereo raw;
  raw.width_px = left.width_px;
  raw.height_px = left.height_px;
  raw.left = raw_camera(left, source);
  raw.right = raw_camera(right, source);
  // R turns each camera into the rectified axes that both share, in which the right one is `baseline` to the right.
  const Matrix from_rectified = transposed(right.rectification);
  raw.rotation = product(from_rectified, left.rectification);
  const double baseline = baseline_m(right, source);
  for (std::size_t i = 0; i < 3; ++i) raw.translation_m[i] = -baseline * from_rectified[3 * i];
  return raw;
}

}  // namespace

bool is_rectified_by_nature(const RosCameraInfo& camera) {
  constexpr Matrix kIdentity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const auto& r = camera.rectification;
  const bool is_turned = std::ranges::any_of(r, [](double value) { return value != 0.0; }) && r != kIdentity;
  return !is_turned && std::ranges::all_of(camera.distortion, [](double value) { return value == 0.0; });
}

Calibration ros_calibration(const RosCameraInfo& left, const RosCameraInfo& right, bool is_rectified,
                            const std::string& source) {
  Calibration calibration;
  calibration.format = "ROS CameraInfo";
  if (left.width_px != right.width_px || left.height_px != right.height_px)
    throw InputError(source, "size",
                     fmt::format("found {} x {} px of the right camera, expected {} x {} px as of the left one",
                                 right.width_px, right.height_px, left.width_px, left.height_px));
  if (!is_rectified) {
    calibration.rectifier.emplace(raw_stereo(left, right, source), source);
    calibration.camera = calibration.rectifier->camera();
    check_camera(calibration.camera, source);
    return calibration;
  }
  const std::string left_key = "P of the left camera", right_key = "P of the right camera";
  const auto numbers = [](const RosCameraInfo& camera) {
    return NumberEntry{{camera.projection.begin(), camera.projection.end()}, ""};
  };
  baseline_m(right, source);  // says best what is wrong with it
  const NumberTable table{source, {{left_key, numbers(left)}, {right_key, numbers(right)}}};
  const Calibration read = detail::calibration_from_projections({table, left_key}, {table, right_key});
  calibration.camera = read.camera;
  calibration.camera.width_px = left.width_px;
  calibration.camera.height_px = left.height_px;
  for (const auto& note : read.notes) calibration.notes.push_back(note);
  check_camera(calibration.camera, source);
  return calibration;
}

}  // namespace flies
