// The formats that are rows of matrices in a text file: KITTI and Middlebury, and what all projection matrices share.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/formats/opencv_names.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

/// Two halves of a rectified pair share focal length and row of the principal point; files round at 1e-6 or better.
constexpr double kFocalTolerance = 1e-3;
constexpr double kRowTolerance_px = 1.0;
/// A right camera this much above or below the left one is worth a note: half a pixel row at a few metres.
constexpr double kNotedOffset_m = 0.001;
/// Rows of a rectified pair match only when the cameras stand level.
constexpr double kMostSlant = 0.1;
constexpr double kMetresPerMillimetre = 1e-3;

struct Intrinsics {
  double fx_px, fy_px, cx_px, cy_px;
};

/// @param stride numbers a row: 3 of a camera matrix, 4 of a projection matrix
Intrinsics read_intrinsics(const std::vector<double>& m, std::size_t stride, const std::string& source,
                           const std::string& key) {
  // Column by column: fx 0 0, 0 fy 0, cx cy 1, and the last column of a projection matrix.
  if (m[0] > 0.0 && m[4] > 0.0 && m[1] == 0.0 && m[2] == 0.0 && m[3] == 0.0 && m[5] == 0.0 && m[8] == 1.0 &&
      (m[6] > 1.0 || m[7] > 1.0))
    throw InputError(source, key, "is transposed, as MATLAB writes it, expected fx 0 cx, 0 fy cy, 0 0 1 in rows");
  if (m[0] == 0.0 || m[stride + 1] == 0.0)
    throw InputError(source, key, "found a focal length of 0, expected a positive one");
  constexpr double kZero = 1e-6;  // relative to the focal length
  if (std::abs(m[1]) > kZero * std::abs(m[0]) || std::abs(m[stride]) > kZero * std::abs(m[0]) ||
      std::abs(m[2 * stride]) > kZero || std::abs(m[2 * stride + 1]) > kZero ||
      std::abs(m[2 * stride + 2] - 1.0) > kZero)
    throw InputError(source, key, "is not of the form fx 0 cx, 0 fy cy, 0 0 1, expected a rectified camera");
  return {m[0], m[stride + 1], m[2], m[stride + 2]};
}

void check_same_rows(const Intrinsics& left, const Intrinsics& right, const std::string& source,
                     const std::string& keys) {
  if (std::abs(left.fx_px - right.fx_px) > kFocalTolerance * std::abs(left.fx_px) ||
      std::abs(left.fy_px - right.fy_px) > kFocalTolerance * std::abs(left.fy_px))
    throw InputError(source, keys,
                     fmt::format("found focal lengths {:.6g}, {:.6g} and {:.6g}, {:.6g} px, expected the same in both "
                                 "images of a rectified pair",
                                 left.fx_px, left.fy_px, right.fx_px, right.fy_px));
  if (std::abs(left.cy_px - right.cy_px) > kRowTolerance_px)
    throw InputError(source, keys,
                     fmt::format("found principal points in rows {:.6g} and {:.6g} px, expected the same row in both "
                                 "images of a rectified pair",
                                 left.cy_px, right.cy_px));
}

bool is_projection_table(const NumberTable& table) { return table.has("P0") || table.has("P2"); }

/// The cameras that are asked for, or the only pair there is.
/// @param pattern of the key that each of them has
std::array<int, 2> kitti_cameras(const NumberTable& table, const CalibrationRequest& request, const char* pattern) {
  const auto key = [&](int camera) { return fmt::format(fmt::runtime(pattern), camera); };
  auto cameras = request.cameras.value_or(request.default_cameras);
  if (!request.cameras && table.has(key(0)) && table.has(key(1)) && !table.has(key(2)) && !table.has(key(3)))
    cameras = {0, 1};
  constexpr int kLeft = 101, kRight = 103;  // as DrivingStereo numbers them
  if (!request.cameras && table.has(key(kLeft)) && table.has(key(kRight))) cameras = {kLeft, kRight};
  for (const int camera : cameras)
    if (!table.has(key(camera)))
      throw InputError(table.source, key(camera), "is missing; choose the cameras of the images, e.g. 0 and 1");
  return cameras;
}

/// KITTI writes whole numbers of pixels as any other number: 1.242000e+03.
ImageSize kitti_size(const NumberTable& table, const char* pattern, const std::array<int, 2>& cameras) {
  const auto key = [&](int camera) { return fmt::format(fmt::runtime(pattern), camera); };
  const ImageSize size = size_of_list(table, key(cameras[0]));
  if (table.has(key(cameras[1])))
    check_same_size(size, size_of_list(table, key(cameras[1])), table.source, key(cameras[1]));
  return size;
}

Calibration read_kitti(const NumberTable& table, const CalibrationRequest& request, const char* pattern,
                       const char* size_pattern) {
  const auto key = [&](int camera) { return fmt::format(fmt::runtime(pattern), camera); };
  const auto cameras = kitti_cameras(table, request, pattern);
  auto calibration = calibration_from_projections({table, key(cameras[0])}, {table, key(cameras[1])});
  // Files of the 2015 benchmark leave the size out.
  const auto has_size = [&](int camera) { return table.has(fmt::format(fmt::runtime(size_pattern), camera)); };
  if (size_pattern != nullptr && (has_size(cameras[0]) || has_size(cameras[1]))) {
    const ImageSize size = kitti_size(table, size_pattern, cameras);
    calibration.camera.width_px = size.width_px;
    calibration.camera.height_px = size.height_px;
  }
  return calibration;
}

/// KITTI raw before rectification: R_0x and T_0x are the pose of the first camera's points in camera x.
Calibration read_unrectified_kitti(const NumberTable& table, const CalibrationRequest& request) {
  const auto cameras = kitti_cameras(table, request, "K_{:02}");
  const auto key = [](const char* name, int camera) { return fmt::format("{}_{:02}", name, camera); };
  const auto camera_of = [&](int camera) {
    return RawCamera{matrix_of(table, key("K", camera)), table.require(key("D", camera)), Lens::brown};
  };
  RawPair pair{{}, key("K", cameras[0]), key("K", cameras[1]), key("R", cameras[1])};
  const ImageSize size = kitti_size(table, "S_{:02}", cameras);
  pair.stereo = {size.width_px, size.height_px, camera_of(cameras[0]), camera_of(cameras[1]), {}, {}};
  const auto pose = [&](int camera) {
    const auto& t = table.require(key("T", camera), 3);
    return Pose{rotation_of(table, key("R", camera), pair.notes), {t[0], t[1], t[2]}};
  };
  set_pose(pair.stereo, chained(pose(cameras[1]), inverse(pose(cameras[0]))));
  return calibration_from_raw(std::move(pair), request, table.source);
}

Calibration read_middlebury(const NumberTable& table, const CalibrationRequest& request) {
  const auto left = read_intrinsics(table.require("cam0", 9), 3, table.source, "cam0");
  const auto right = read_intrinsics(table.require("cam1", 9), 3, table.source, "cam1");
  check_same_rows(left, right, table.source, "cam0, cam1");
  Calibration calibration;
  auto& camera = calibration.camera;
  camera.fx_px = left.fx_px;
  camera.fy_px = left.fy_px;
  camera.cx_px = left.cx_px;
  camera.cy_px = left.cy_px;
  camera.cx_right_px = right.cx_px;
  if (table.has("doffs")) {
    camera.cx_right_px = left.cx_px + table.require_number("doffs");
    if (std::abs(camera.cx_right_px - right.cx_px) > kRowTolerance_px)
      calibration.notes.push_back(
          {fmt::format("doffs differs by {:.2f} px from the principal points of cam0 and cam1; doffs is used",
                       camera.cx_right_px - right.cx_px)});
  }
  camera.baseline_m = table.has("baseline") ? table.require_number("baseline") * kMetresPerMillimetre
                                            : missing_baseline(request, table.source, "baseline");
  if (table.has("width") || table.has("height")) {
    camera.width_px = table.require_size("width");
    camera.height_px = table.require_size("height");
  }
  calibration.left_name = "cam0";
  calibration.right_name = "cam1";
  return calibration;
}

}  // namespace

Calibration calibration_from_projections(const ProjectionKey& left_key, const ProjectionKey& right_key) {
  const auto& left_numbers = left_key.table.require(left_key.key, 12);
  const auto& right_numbers = right_key.table.require(right_key.key, 12);
  const auto left = read_intrinsics(left_numbers, 4, left_key.table.source, left_key.key);
  const auto right = read_intrinsics(right_numbers, 4, right_key.table.source, right_key.key);
  check_same_rows(left, right, right_key.table.source, left_key.key + ", " + right_key.key);

  // P = K [I | t]: undo K to get the positions of both cameras.
  const auto position = [](const std::vector<double>& p, const Intrinsics& k) {
    return std::array{(p[3] - k.cx_px * p[11]) / k.fx_px, (p[7] - k.cy_px * p[11]) / k.fy_px, p[11]};
  };
  const auto left_m = position(left_numbers, left), right_m = position(right_numbers, right);

  Calibration calibration;
  auto& camera = calibration.camera;
  camera.fx_px = left.fx_px;
  camera.fy_px = left.fy_px;
  camera.cx_px = left.cx_px;
  camera.cx_right_px = right.cx_px;
  camera.cy_px = left.cy_px;
  camera.baseline_m = left_m[0] - right_m[0];
  calibration.left_name = left_key.key;
  calibration.right_name = right_key.key;
  const auto note_offset = [&](double offset_m, const char* direction) {
    if (std::abs(offset_m) > kNotedOffset_m)
      calibration.notes.push_back({fmt::format("{} offset of {:.4f} m between {} and {} ignored", direction, offset_m,
                                               left_key.key, right_key.key),
                                   CalibrationNoteKind::told});
  };
  const double across_m = std::abs(camera.baseline_m), down_m = std::abs(right_m[1] - left_m[1]);
  if (down_m > kMostSlant * across_m)
    throw InputError(right_key.table.source, right_key.key,
                     fmt::format("the cameras stand {} ({:.4g} m across and {:.4g} m down), expected side by side",
                                 down_m > across_m ? "one above the other" : "aslant", across_m, down_m));
  note_offset(right_m[1] - left_m[1], "vertical");
  note_offset(right_m[2] - left_m[2], "forward");
  return calibration;
}

const CalibrationFormat kKittiObject{
    "KITTI object calib.txt", true, false,
    [](const NumberTable& table) {
      return is_projection_table(table) &&
             (table.has("R0_rect") || table.has("R_rect") || table.has("Tr_velo_to_cam") || table.has("Tr_velo_cam"));
    },
    [](const NumberTable& table, const CalibrationRequest& request) {
      return read_kitti(table, request, "P{}", nullptr);
    }};

const CalibrationFormat kKittiRaw{"KITTI raw calib_cam_to_cam.txt", true, false,
                                  [](const NumberTable& table) {
                                    return table.has("P_rect_00") || table.has("P_rect_02") || table.has("P_rect_101");
                                  },
                                  [](const NumberTable& table, const CalibrationRequest& request) {
                                    return request.images_are_raw
                                               ? read_unrectified_kitti(table, request)
                                               : read_kitti(table, request, "P_rect_{:02}", "S_rect_{:02}");
                                  }};

const CalibrationFormat kKittiOdometry{"KITTI odometry calib.txt", true, false,
                                       [](const NumberTable& table) {
                                         const bool has_pair = (table.has("P0") && table.has("P1")) ||
                                                               (table.has("P2") && table.has("P3"));
                                         return has_pair && !opencv_names(table).has_matrices;
                                       },
                                       [](const NumberTable& table, const CalibrationRequest& request) {
                                         return read_kitti(table, request, "P{}", nullptr);
                                       }};

const CalibrationFormat kMiddlebury{"Middlebury calib.txt", false, false,
                                    [](const NumberTable& table) { return table.has("cam0") || table.has("cam1"); },
                                    read_middlebury};

}  // namespace flies::detail
