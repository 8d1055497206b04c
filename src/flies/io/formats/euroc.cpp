// A sensor.yaml for each camera, as the EuRoC MAV data set has them, and Kimera after it: T_BS is the camera's pose in
// the frame of the body.
#include "flies/io/formats/distortion_names.hpp"
#include "flies/io/formats/raw_pair.hpp"
#include "flies/io/formats/second_file.hpp"

namespace flies::detail {
namespace {

RawCamera read_camera(const NumberTable& table) {
  RawCamera raw;
  raw.lens = lens_of(table.word("distortion_model"), "distortion_model", table.source);
  const auto& numbers = table.require("intrinsics", 4);
  raw.matrix = camera_matrix(numbers[0], numbers[1], numbers[2], numbers[3]);
  raw.distortion = distortion_of(table, "", raw.lens);
  if (raw.distortion.empty() && table.word("distortion_model") == "none") raw.distortion.resize(4);
  return raw;
}

Calibration read_euroc(const NumberTable& left, const CalibrationRequest& request) {
  const NumberTable right = read_right_file(left, request);
  RawPair pair{{}, left.source, right.source, "T_BS"};
  pair.stereo.left = read_camera(left);
  pair.stereo.right = read_camera(right);
  const Pose body_from_left = pose_of(left, "T_BS", pair.notes);
  const Pose body_from_right = pose_of(right, "T_BS", pair.notes);
  set_body_poses(pair, body_from_left, body_from_right);
  const auto size = size_of_list(left, "resolution"), other = size_of_list(right, "resolution");
  check_same_size(size, other, right.source, "resolution");
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  return calibration_from_raw(std::move(pair), request, left.source + " with " + right.source);
}

}  // namespace

const CalibrationFormat kEuroc{"EuRoC sensor.yaml pair", false, true,
                               [](const NumberTable& table) { return table.has("T_BS") && table.has("intrinsics"); },
                               read_euroc};

}  // namespace flies::detail
