// Programs that write, in one file, each camera's numbers and its pose in the frame of a body: OKVIS, OV2SLAM, and
// Kimera before it took EuRoC's files. https://github.com/ethz-asl/okvis, https://github.com/ov2slam/ov2slam
#include <array>

#include "flies/core/error.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

/// What one of these programs says of a camera.
struct Placed {
  RawCamera camera;
  Pose body_from_camera;
  ImageSize size;
  std::string key;  ///< that its numbers stand at
};

using ReadCamera = Placed (*)(const NumberTable& table, std::size_t side, CalibrationNotes& notes);

template <ReadCamera read_camera>
Calibration read_both(const NumberTable& table, const CalibrationRequest& request) {
  RawPair pair;
  const Placed left = read_camera(table, 0, pair.notes), right = read_camera(table, 1, pair.notes);
  pair.left_key = left.key;
  pair.right_key = pair.pose_key = right.key;
  pair.stereo.left = left.camera;
  pair.stereo.right = right.camera;
  set_pose(pair.stereo, chained(inverse(right.body_from_camera), left.body_from_camera));
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
          of + "focal_length"};
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
  placed.body_from_camera = pose_of(table, is_left ? "body_T_cam0" : "body_T_cam1", notes);
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
          of + "intrinsics"};
}

}  // namespace

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
