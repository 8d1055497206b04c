// DSEC's cam_to_cam.yaml: https://dsec.ifi.uzh.ch/data-format/. Cameras 1 and 2 see frames, 0 and 3 events; camRectX is
// camera X rectified, T_XY takes points of camera Y into the frame of X; metres.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

using Cameras = std::array<int, 2>;

constexpr Cameras kFrames = {1, 2};

std::string raw_key(int camera) { return fmt::format("intrinsics.cam{}", camera); }
std::string rectified_key(int camera) { return fmt::format("intrinsics.camRect{}", camera); }
std::string reprojection_key(Cameras cameras) {
  return fmt::format("disparity_to_depth.cams_{}{}", cameras[0], cameras[1]);
}

std::array<double, 9> matrix_at(const NumberTable& table, const std::string& camera) {
  const auto& numbers = table.require(camera + ".camera_matrix", 4);
  return camera_matrix(numbers[0], numbers[1], numbers[2], numbers[3]);
}

ImageSize size_of(const NumberTable& table, const std::string& left, const std::string& right) {
  const auto size = size_of_list(table, left + ".resolution");
  check_same_size(size, size_of_list(table, right + ".resolution"), table.source, right + ".resolution");
  return size;
}

/// The baseline stands in the matrix that reprojects disparities, as OpenCV's Q: 1 / q[14].
Calibration read_rectified(const NumberTable& table, Cameras cameras) {
  const std::string key = reprojection_key(cameras), left = rectified_key(cameras[0]),
                    right = rectified_key(cameras[1]);
  if (!table.has(key))
    throw InputError(table.source, key,
                     "is missing, but rectified images need it: --cameras 1,2 are the frame cameras, 0,3 the event "
                     "cameras; others work only with --raw");
  const auto& q = table.require(key, 16);
  const auto of_left = matrix_at(table, left), of_right = matrix_at(table, right);
  constexpr double kAlike = 1e-3;
  const auto is_like = [&](double a, double b) { return std::abs(a - b) <= kAlike * std::abs(a); };
  if (!is_like(of_left[0], of_right[0]) || !is_like(of_left[0], q[11]) || q[14] == 0.0)
    throw InputError(table.source, key,
                     fmt::format("found focal length {:.6g} px and 1 / baseline {:.6g}, expected that of {} and {}, "
                                 "{:.6g} and {:.6g} px, and not 0",
                                 q[11], q[14], left, right, of_left[0], of_right[0]));
  const auto size = size_of(table, left, right);
  Calibration calibration;
  auto& camera = calibration.camera;
  camera.fx_px = of_left[0];
  camera.fy_px = of_left[4];
  camera.cx_px = of_left[2];
  camera.cx_right_px = of_right[2];
  camera.cy_px = of_left[5];
  camera.baseline_m = 1.0 / q[14];
  camera.width_px = size.width_px;
  camera.height_px = size.height_px;
  calibration.left_name = left;
  calibration.right_name = right;
  calibration.notes.push_back(
      {fmt::format(
           "the images are taken as rectified, those of {} and {} (give --raw if they are as the cameras gave them)",
           left, right),
       CalibrationNoteKind::told});
  return calibration;
}

RawCamera raw_camera(const NumberTable& table, const std::string& key) {
  const std::string model = key + ".distortion_model";
  return {matrix_at(table, key), table.require(key + ".distortion_coeffs"),
          lens_of(table.word(model), model, table.source)};
}

/// Along T_10, T_21, T_32.
Pose from_first(const NumberTable& table, int camera, CalibrationNotes& notes) {
  Pose pose;
  for (int i = 1; i <= camera; ++i)
    pose = chained(pose_of(table, fmt::format("extrinsics.T_{}{}", i, i - 1), notes), pose);
  return pose;
}

Calibration read_raw(const NumberTable& table, Cameras cameras, const CalibrationRequest& request) {
  const std::string left = raw_key(cameras[0]), right = raw_key(cameras[1]);
  RawPair pair{{}, left, right, "extrinsics"};
  const auto size = size_of(table, left, right);
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  pair.stereo.left = raw_camera(table, left);
  pair.stereo.right = raw_camera(table, right);
  set_pose(pair.stereo,
           chained(from_first(table, cameras[1], pair.notes), inverse(from_first(table, cameras[0], pair.notes))));
  return calibration_from_raw(std::move(pair), request, table.source);
}

Calibration read_dsec(const NumberTable& table, const CalibrationRequest& request) {
  const Cameras cameras = request.cameras.value_or(kFrames);
  return request.images_are_raw ? read_raw(table, cameras, request) : read_rectified(table, cameras);
}

}  // namespace

const CalibrationFormat kDsec{"DSEC cam_to_cam.yaml", true, false,
                              [](const NumberTable& table) {
                                return std::ranges::any_of(std::array{0, 1, 2, 3}, [&](int camera) {
                                  return table.has(rectified_key(camera) + ".camera_matrix");
                                });
                              },
                              read_dsec};

}  // namespace flies::detail
