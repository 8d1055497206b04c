// Kalibr's camchain.yaml: https://github.com/ethz-asl/kalibr/wiki/yaml-formats
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/formats/cross_checks.hpp"
#include "flies/io/formats/distortion_names.hpp"
#include "flies/io/formats/nesting.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

std::string name_of(int camera) { return fmt::format("cam{}", camera); }

/// @throws InputError when there are coefficients that are not 0, and no model that they are of
void check_no_distortion_of(const NumberTable& table, const std::string& camera, const std::string& model_key) {
  for (const auto& [key, entry] : table.entries)
    if (key.starts_with(camera + ".") && holds_distortion(key, entry))
      throw InputError(table.source, model_key,
                       fmt::format("{}, and {} holds coefficients: expected their model, radtan or equidistant",
                                   table.has(model_key) ? "found 'none'" : "is missing", key));
}

/// What stands before the camera's focal lengths in `intrinsics`, and the lens that says so.
RawCamera read_camera(const NumberTable& table, const std::string& camera) {
  const std::string model_key = camera + ".camera_model", model = table.word(model_key);
  RawCamera raw;
  raw.lens = lens_of(model, model_key, table.source);
  const std::size_t own = raw.lens == Lens::mei                                          ? 1
                          : raw.lens == Lens::double_sphere || raw.lens == Lens::unified ? 2
                                                                                         : 0;
  const auto& numbers = table.require(camera + ".intrinsics", own + 4);
  raw.distortion.assign(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(own));
  raw.matrix = camera_matrix(numbers[own], numbers[own + 1], numbers[own + 2], numbers[own + 3]);
  const std::string distortion_key = camera + ".distortion_model", distortion = table.word(distortion_key);
  if (distortion.empty() || distortion == "none") {
    check_no_distortion_of(table, camera, distortion_key);
    if (distortion == "none" && (raw.lens == Lens::brown || raw.lens == Lens::mei)) raw.distortion.resize(own + 4);
    return raw;
  }
  const Lens bent = lens_of(distortion, distortion_key, table.source);
  if (raw.lens == Lens::brown) raw.lens = bent;
  if (own > 0 && (raw.lens != Lens::mei || bent != Lens::brown))
    throw InputError(table.source, distortion_key,
                     fmt::format("found '{}' beside the camera model '{}', which has none", distortion, model));
  const auto found = distortion_below(table, camera + ".", bent);
  const auto& coefficients = found.key.empty() ? table.require(camera + ".distortion_coeffs") : found.coefficients;
  raw.distortion.insert(raw.distortion.end(), coefficients.begin(), coefficients.end());
  return raw;
}

/// How files that do not chain cameras call the frame of a body in that of the camera, and the inverse of that.
constexpr std::array kFromBody = {"T_cam_imu", "T_cam_body", "T_C_B"};
constexpr std::array kToBody = {"T_imu_cam", "T_body_cam", "T_B_C"};

/// The key of a camera's pose in the frame of a body; "" when it has none.
std::string key_of_body(const NumberTable& table, int camera) {
  for (const auto& names : {kFromBody, kToBody})
    for (const char* name : names)
      if (auto key = name_of(camera) + "." + name; table.has(key)) return key;
  return "";
}

Pose body_from_camera(const NumberTable& table, int camera, CalibrationNotes& notes) {
  const std::string key = key_of_body(table, camera);
  const Pose pose = pose_of(table, key, notes);
  const bool is_inverse = std::ranges::any_of(kFromBody, [&](const char* name) { return key.ends_with(name); });
  return is_inverse ? inverse(pose) : pose;
}

bool have_body(const NumberTable& table, const std::array<int, 2>& cameras) {
  return !key_of_body(table, cameras[0]).empty() && !key_of_body(table, cameras[1]).empty();
}

/// Points of a camera in the frame of a later one: the file chains each to the one before it.
Pose along_chain(const NumberTable& table, int from, int to, CalibrationNotes& notes) {
  Pose pose;
  for (int i = from + 1; i <= to; ++i) {
    const std::string key = name_of(i) + ".T_cn_cnm1";
    if (!table.has(key))
      throw InputError(table.source, key, "is missing, and so is T_cam_imu or T_imu_cam of both cameras");
    pose = chained(pose_of(table, key, notes), pose);
  }
  return pose;
}

/// From the left to the right camera.
Pose by_chain(const NumberTable& table, const std::array<int, 2>& cameras, CalibrationNotes& notes) {
  const auto [left, right] = cameras;
  return left < right ? along_chain(table, left, right, notes) : inverse(along_chain(table, right, left, notes));
}

/// Notes that the poses of the inertial unit, which a chained file need not have, say another distance.
void note_inertial(const NumberTable& table, const std::array<int, 2>& cameras, const FoundNumber& used,
                   const CalibrationRequest& request, CalibrationNotes& notes) {
  if (!have_body(table, cameras)) return;
  try {
    CalibrationNotes of_unused;
    const Pose right = body_from_camera(table, cameras[1], of_unused);
    const Pose pose = chained(inverse(right), body_from_camera(table, cameras[0], of_unused));
    const std::string key = key_of_body(table, cameras[1]);
    note_other_baseline(used, length_of(key.substr(key.find('.') + 1), pose), request, notes);
  } catch (const InputError&) {
    return;  // no poses, and nobody asked for them
  }
}

constexpr int kMostCameras = 10;

/// Those that are asked for, or the first two of the file; a chain may have been cut out of a longer one.
std::array<int, 2> cameras_of(const NumberTable& table, const CalibrationRequest& request) {
  const auto has = [&](int camera) { return table.has(name_of(camera) + ".intrinsics"); };
  if (request.cameras || has(0)) return request.cameras.value_or(std::array{0, 1});
  int first = 1;
  while (first < kMostCameras && !has(first)) ++first;
  return {first, first + 1};
}

/// What stands before this key, below no other or below those of programs that keep the file's content below a key of
/// theirs.
std::optional<std::string> prefix_of_key(const NumberTable& table, const std::string& end) {
  for (const auto& [key, entry] : table.entries)
    if (key.ends_with(end) && (key.size() == end.size() || key[key.size() - end.size() - 1] == '.'))
      return key.substr(0, key.size() - end.size());
  return std::nullopt;
}

/// What stands before "cam0", or before the first camera of a chain that lacks it.
std::optional<std::string> prefix_of(const NumberTable& table) {
  if (auto prefix = prefix_of_key(table, "cam0.intrinsics")) return prefix;
  for (int camera = 1; camera < kMostCameras; ++camera)
    if (auto prefix = prefix_of_key(table, name_of(camera) + ".T_cn_cnm1")) return prefix;
  return std::nullopt;
}

Calibration read_kalibr(const NumberTable& file, const CalibrationRequest& request) {
  const NumberTable table = below(file, prefix_of(file).value_or(""));
  const auto cameras = cameras_of(table, request);
  const std::string left = name_of(cameras[0]), right = name_of(cameras[1]);
  RawPair pair{{}, left, right, right + ".T_cn_cnm1"};
  pair.stereo.left = read_camera(table, left);
  pair.stereo.right = read_camera(table, right);
  if (table.has("cam1.T_cn_cnm1") || !have_body(table, cameras)) {
    const Pose pose = by_chain(table, cameras, pair.notes);
    set_pose(pair.stereo, pose);
    note_inertial(table, cameras, length_of("T_cn_cnm1", pose), request, pair.notes);
  } else {
    pair.pose_key = key_of_body(table, cameras[1]);
    const Pose body_from_left = body_from_camera(table, cameras[0], pair.notes);
    set_body_poses(pair, body_from_left, body_from_camera(table, cameras[1], pair.notes));
  }
  const auto size = size_of_list(table, left + ".resolution"), other = size_of_list(table, right + ".resolution");
  check_same_size(size, other, table.source, right + ".resolution");
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  return calibration_from_raw(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kKalibr{"Kalibr camchain", true, false,
                                [](const NumberTable& table) { return prefix_of(table).has_value(); }, read_kalibr};

}  // namespace flies::detail
