// Argoverse 1's vehicle_calibration_info.json: a list of cameras by name, each with its pose in the frame of the
// vehicle; metres. https://github.com/argoverse/argoverse-api
#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

/// What stands before the numbers of the stereo camera of this side; the ring's cameras are no pair.
std::string camera_of(const NumberTable& table, const std::string& side) {
  const std::string name = "stereo_front_" + side;
  for (int i = 0; table.has(fmt::format("camera_data_.{}.key", i)); ++i)
    if (table.word(fmt::format("camera_data_.{}.key", i)).find(name) != std::string::npos)
      return fmt::format("camera_data_.{}.value.", i);
  throw InputError(table.source, "camera_data_", fmt::format("has no camera {}", name));
}

RawCamera argoverse_camera(const NumberTable& table, const std::string& camera) {
  const auto number = [&](const char* name) { return table.require_number(camera + name); };
  auto matrix = camera_matrix(number("focal_length_x_px_"), number("focal_length_y_px_"), number("focal_center_x_px_"),
                              number("focal_center_y_px_"));
  if (table.has(camera + "skew_")) matrix[1] = number("skew_");
  const auto& radial = table.require(camera + "distortion_coefficients_", 3);
  return {matrix, {radial[0], radial[1], 0.0, 0.0, radial[2]}, Lens::brown};
}

/// A quaternion whose real part comes first: all four numbers of a camera that looks ahead are near 0.5, so that its
/// order cannot be told from them.
Pose vehicle_from_camera(const NumberTable& table, const std::string& camera) {
  const std::string key = camera + "vehicle_SE3_camera_.rotation.coefficients";
  const auto& q = table.require(key, 4);
  const auto& t = table.require(camera + "vehicle_SE3_camera_.translation", 3);
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const std::array<double, 9> rotation = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                                          2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                                          2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  check_rotation(rotation, table.source, key);
  return {rotation, {t[0], t[1], t[2]}};
}

Calibration read_argoverse(const NumberTable& table, const CalibrationRequest& request) {
  const std::string left = camera_of(table, "left"), right = camera_of(table, "right");
  RawPair pair{{}, left + "focal_length_x_px_", right + "focal_length_x_px_", right + "vehicle_SE3_camera_"};
  pair.distortion_keys = {left + "distortion_coefficients_", right + "distortion_coefficients_"};
  pair.stereo.left = argoverse_camera(table, left);
  pair.stereo.right = argoverse_camera(table, right);
  set_body_poses(pair, vehicle_from_camera(table, left), vehicle_from_camera(table, right));
  return calibration_from_pair(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kArgoverse{"Argoverse 1", false, false,
                                   [](const NumberTable& table) { return table.has("camera_data_.0.key"); },
                                   read_argoverse};

}  // namespace flies::detail
