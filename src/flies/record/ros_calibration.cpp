#include "flies/record/ros_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "flies/io/calibration_formats.hpp"
#include "flies/io/formats/lens_names.hpp"

namespace flies {
namespace {

using Matrix = std::array<double, 9>;

bool is_zero(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double number) { return number == 0.0; });
}

/// The model of the lens as files have it: one word.
std::string model_of(const RosCameraInfo& camera) {
  return camera.distortion_model.substr(0, camera.distortion_model.find(' '));
}

/// Whether the rectified picture has the focal lengths and the principal point that the camera has.
bool keeps_its_pixels(const RosCameraInfo& camera) {
  constexpr double kSame = 1e-6;
  const auto& k = camera.intrinsics;
  const auto& p = camera.projection;
  const Matrix rectified = {p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]};
  return std::ranges::equal(k, rectified,
                            [&](double a, double b) { return std::abs(a - b) <= kSame * std::abs(k[0]); });
}

std::string prefix_of(const RosCameraInfo& camera) { return camera.topic.empty() ? "" : camera.topic + " "; }

/// What a message says, under the names that it has in files.
NumberTable table_of(const RosCameraInfo& camera, const std::string& source) {
  NumberTable table{source, {}};
  const std::string prefix = prefix_of(camera);
  const auto put = [&](const char* name, std::span<const double> numbers) {
    table.entries[prefix + name].numbers.assign(numbers.begin(), numbers.end());
  };
  const auto put_count = [&](const char* name, int count) {
    if (count != 0) table.entries[prefix + name].numbers = {static_cast<double>(count)};
  };
  table.entries[prefix + "distortion_model"].not_a_number = model_of(camera);
  put("D", camera.distortion);
  put("K", camera.intrinsics);
  put("R", camera.rectification);
  put("P", camera.projection);
  put_count("width", camera.width_px);
  put_count("height", camera.height_px);
  put_count("binning_x", camera.binning_x);
  put_count("binning_y", camera.binning_y);
  put_count("roi.x_offset", camera.window.x_px);
  put_count("roi.y_offset", camera.window.y_px);
  put_count("roi.width", camera.window.width_px);
  put_count("roi.height", camera.window.height_px);
  return table;
}

}  // namespace

bool is_rectified_by_nature(const RosCameraInfo& camera) {
  constexpr Matrix kIdentity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const bool is_turned = !is_zero(camera.rectification) && camera.rectification != kIdentity;
  // A fisheye without coefficients still maps angles to pixels in equal steps. Unknown models are told by who reads
  // them.
  const auto lens = detail::known_lens(table_of(camera, "").word(prefix_of(camera) + "distortion_model"));
  const bool is_straight = lens == Lens::brown;
  return is_straight && !is_turned && is_zero(camera.distortion) && keeps_its_pixels(camera);
}

Calibration ros_calibration(const RosCameraInfo& left, const RosCameraInfo& right, const CalibrationRequest& request,
                            const std::string& source, const std::optional<CameraMount>& mount) {
  const NumberTable left_table = table_of(left, source), right_table = table_of(right, source);
  Calibration calibration =
      detail::calibration_from_ros({left_table, prefix_of(left)}, {right_table, prefix_of(right)}, request);
  calibration.format = "ROS CameraInfo";
  if (mount) {
    calibration.camera.mount = *mount;
    calibration.has_height = calibration.has_pitch = true;
  }
  return detail::completed(std::move(calibration), request, source);
}

}  // namespace flies
