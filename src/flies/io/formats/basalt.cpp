// Calibration of Basalt: https://gitlab.com/VladyslavUsenko/basalt/-/blob/master/doc/Calibration.md
#include <fmt/format.h>

#include <cmath>

#include "flies/core/error.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

RawCamera read_camera(const NumberTable& table, int camera) {
  const std::string prefix = fmt::format("value0.intrinsics.{}.", camera), type_key = prefix + "camera_type";
  const std::string of = prefix + "intrinsics.", type = table.word(type_key);
  const auto number = [&](const char* name) { return table.require_number(of + name); };
  RawCamera raw;
  raw.matrix = camera_matrix(number("fx"), number("fy"), number("cx"), number("cy"));
  raw.lens = lens_of(type, type_key, table.source);
  if (raw.lens == Lens::double_sphere) raw.distortion = {number("xi"), number("alpha")};
  if (raw.lens == Lens::unified) raw.distortion = {number("alpha"), type == "eucm" ? number("beta") : 1.0};
  if (raw.lens == Lens::equidistant) raw.distortion = {number("k1"), number("k2"), number("k3"), number("k4")};
  if (type == "pinhole") raw.distortion.resize(4);
  if (type == "pinhole-radtan8")
    raw.distortion = {number("k1"), number("k2"), number("p1"), number("p2"),
                      number("k3"), number("k4"), number("k5"), number("k6")};
  return raw;
}

/// The pose of a camera in the frame of the inertial unit, its rotation a quaternion.
Pose read_pose(const NumberTable& table, int camera) {
  const std::string prefix = fmt::format("value0.T_imu_cam.{}.", camera);
  const auto number = [&](const char* name) { return table.require_number(prefix + name); };
  double x = number("qx"), y = number("qy"), z = number("qz"), w = number("qw");
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  constexpr double kRounding = 1e-2;
  if (std::abs(length - 1.0) > kRounding)
    throw InputError(table.source, prefix + "qw",
                     fmt::format("is part of a quaternion of length {:.3g}, expected 1", length));
  x /= length, y /= length, z /= length, w /= length;
  return {
      {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z),
       2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)},
      {number("px"), number("py"), number("pz")}};
}

ImageSize read_size(const NumberTable& table, int camera) {
  const std::string key = "value0.resolution";
  const auto& sizes = table.require(key);  // lists of lists are one list
  const auto at = static_cast<std::size_t>(2 * camera);
  if (sizes.size() < at + 2) throw InputError(table.source, key, fmt::format("has no size for camera {}", camera));
  return size_of_list({table.source, {{key, {{sizes[at], sizes[at + 1]}, ""}}}}, key);
}

Calibration read_basalt(const NumberTable& table, const CalibrationRequest& request) {
  const auto [left, right] = request.cameras.value_or(std::array{0, 1});
  RawPair pair{{},
               fmt::format("value0.intrinsics.{}", left),
               fmt::format("value0.intrinsics.{}", right),
               fmt::format("value0.T_imu_cam.{}", right)};
  pair.stereo.left = read_camera(table, left);
  pair.stereo.right = read_camera(table, right);
  set_body_poses(pair, read_pose(table, left), read_pose(table, right));
  const ImageSize size = read_size(table, left);
  check_same_size(size, read_size(table, right), table.source, "value0.resolution");
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  return calibration_from_raw(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kBasalt{"Basalt calibration", true, false,
                                [](const NumberTable& table) { return table.has("value0.T_imu_cam.0.px"); },
                                read_basalt};

}  // namespace flies::detail
