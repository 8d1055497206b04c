// Programs that write, in one file, each camera's numbers and its pose in the frame of a body: OKVIS, OV2SLAM, and
// Kimera before it took EuRoC's files, maplab and SVO Pro. https://github.com/ethz-asl/okvis,
// https://github.com/ov2slam/ov2slam, https://github.com/ethz-asl/maplab
#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

/// What one of these programs says of a camera.
struct Placed {
  RawCamera camera;
  Pose body_from_camera;
  ImageSize size;
  std::string key;       ///< that its numbers stand at
  std::string pose_key;  ///< and its pose
};

using ReadCamera = Placed (*)(const NumberTable& table, std::size_t side, CalibrationNotes& notes);

template <ReadCamera read_camera>
Calibration read_both(const NumberTable& table, const CalibrationRequest& request) {
  RawPair pair;
  const Placed left = read_camera(table, 0, pair.notes), right = read_camera(table, 1, pair.notes);
  pair.left_key = left.key;
  pair.right_key = right.key;
  pair.pose_key = right.pose_key;
  pair.stereo.left = left.camera;
  pair.stereo.right = right.camera;
  set_body_poses(pair, left.body_from_camera, right.body_from_camera);
  check_same_size(left.size, right.size, table.source, right.key);
  pair.stereo.width_px = left.size.width_px;
  pair.stereo.height_px = left.size.height_px;
  return calibration_from_raw(std::move(pair), request, table.source);
}

std::array<double, 9> matrix_of_four(const std::vector<double>& numbers) {
  return camera_matrix(numbers[0], numbers[1], numbers[2], numbers[3]);
}

Placed read_okvis(const NumberTable& table, std::size_t side, CalibrationNotes& notes) {
  const std::string of = "cameras." + std::to_string(side) + ".", model = of + "distortion_type";
  const auto &focal = table.require(of + "focal_length", 2), &centre = table.require(of + "principal_point", 2);
  return {{camera_matrix(focal[0], focal[1], centre[0], centre[1]), table.require(of + "distortion_coefficients"),
           lens_of(table.word(model), model, table.source)},
          pose_of(table, of + "T_SC", notes),
          size_of_list(table, of + "image_dimension"),
          of + "focal_length",
          of + "T_SC"};
}

Placed read_ov2slam(const NumberTable& table, std::size_t side, CalibrationNotes& notes) {
  const bool is_left = side == 0;
  const std::string name = is_left ? "left" : "right", end = is_left ? "l" : "r", model = "Camera.model_" + name;
  const auto number = [&](const std::string& of) { return table.require_number("Camera." + of + end); };
  Placed placed;
  placed.camera.lens = lens_of(table.word(model), model, table.source);
  placed.camera.matrix = camera_matrix(number("fx"), number("fy"), number("cx"), number("cy"));
  const bool is_fisheye = placed.camera.lens == Lens::equidistant;
  for (const char* of : {"k1", "k2", is_fisheye ? "k3" : "p1", is_fisheye ? "k4" : "p2"})
    placed.camera.distortion.push_back(number(of));
  placed.pose_key = is_left ? "body_T_cam0" : "body_T_cam1";
  placed.body_from_camera = pose_of(table, placed.pose_key, notes);
  placed.size = {table.require_size("Camera." + name + "_nwidth"), table.require_size("Camera." + name + "_nheight")};
  placed.key = "Camera.fx" + end;
  return placed;
}

Placed read_kimera(const NumberTable& table, std::size_t side, CalibrationNotes& notes) {
  const std::string of = side == 0 ? "left_camera_" : "right_camera_";
  return {{matrix_of_four(table.require(of + "intrinsics", 4)), table.require(of + "distortion_coefficients"),
           lens_of(table.word("distortion_model"), "distortion_model", table.source)},
          pose_of(table, of + "extrinsics", notes),
          size_of_list(table, "camera_resolution"),
          of + "intrinsics",
          of + "extrinsics"};
}

constexpr std::string_view kMaplabIntrinsics = "cameras.0.camera.intrinsics";

/// What stands before the list of cameras, as maplab may have other sensors in its file.
std::optional<std::string> before_maplab(const NumberTable& table) {
  for (const auto& [key, entry] : table.entries)
    if (key.ends_with(kMaplabIntrinsics)) return key.substr(0, key.size() - kMaplabIntrinsics.size());
  return std::nullopt;
}

/// The lens by its own name and that of its distortion, of which maplab calls `fisheye` what others call `fov`.
Lens lens_of_maplab(const NumberTable& table, const std::string& camera) {
  const std::string type_key = camera + "type", type = table.word(type_key);
  const std::string bent_key = camera + "distortion.type", bent = table.word(bent_key);
  if (!type.empty() && type != "pinhole" && type != "unified-projection")
    throw InputError(table.source, type_key, fmt::format("found '{}', expected pinhole or unified-projection", type));
  if (type != "unified-projection") return bent == "fisheye" ? Lens::fov : lens_of(bent, bent_key, table.source);
  if (bent.empty() || bent == "none" || lens_of(bent, bent_key, table.source) == Lens::brown) return Lens::mei;
  throw InputError(table.source, bent_key,
                   fmt::format("found '{}' beside unified-projection, expected none or radial-tangential", bent));
}

Placed read_maplab(const NumberTable& table, std::size_t side, CalibrationNotes& notes) {
  const std::string of = *before_maplab(table) + "cameras." + std::to_string(side) + ".", camera = of + "camera.",
                    coefficients = camera + "distortion.parameters";
  Placed placed;
  placed.key = camera + "intrinsics";
  placed.pose_key = of + "T_B_C";
  placed.camera.lens = lens_of_maplab(table, camera);
  const std::size_t own = placed.camera.lens == Lens::mei ? 1 : 0;
  const auto& numbers = table.require(placed.key, own + 4);
  placed.camera.distortion.assign(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(own));
  placed.camera.matrix = matrix_of_four({numbers.begin() + static_cast<std::ptrdiff_t>(own), numbers.end()});
  const std::string bent = table.word(camera + "distortion.type");
  if (!bent.empty() && bent != "none") {
    const auto& found = table.require(coefficients);
    placed.camera.distortion.insert(placed.camera.distortion.end(), found.begin(), found.end());
  }
  placed.body_from_camera = pose_of(table, placed.pose_key, notes);
  placed.size = {table.require_size(camera + "image_width"), table.require_size(camera + "image_height")};
  return placed;
}

}  // namespace

const CalibrationFormat kMaplab{"maplab cameras", false, false,
                                [](const NumberTable& table) { return before_maplab(table).has_value(); },
                                read_both<read_maplab>};
const CalibrationFormat kOkvis{"OKVIS configuration", false, false,
                               [](const NumberTable& table) { return table.has("cameras.0.T_SC"); },
                               read_both<read_okvis>};
const CalibrationFormat kOv2Slam{"OV2SLAM parameters", false, false,
                                 [](const NumberTable& table) { return table.has("Camera.fxl"); },
                                 read_both<read_ov2slam>};
const CalibrationFormat kKimera{"Kimera's file of both cameras", false, false,
                                [](const NumberTable& table) { return table.has("left_camera_extrinsics"); },
                                read_both<read_kimera>};

}  // namespace flies::detail
