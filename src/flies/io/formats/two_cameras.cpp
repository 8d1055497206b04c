// Two cameras of a few keys each and what lies between them: MRPT's configurations, and what scripts dump of a
// RealSense or another stereo camera (JSON or YAML).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/formats/distortion_names.hpp"
#include "flies/io/formats/nesting.hpp"
#include "flies/io/formats/opencv_names.hpp"
#include "flies/io/formats/quantities.hpp"
#include "flies/io/formats/raw_pair.hpp"
#include "flies/io/formats/sides.hpp"
#include "flies/io/formats/stated_size.hpp"

namespace flies::detail {
namespace {

// MRPT (TStereoCamera::loadFromConfigFile): three sections, whose names begin alike; metres.
constexpr std::string_view kMrptPose = "_LEFT2RIGHT_POSE.pose_quaternion";

/// What the names of the sections begin with.
std::optional<std::string> mrpt_sections(const NumberTable& table) {
  for (const auto& [key, entry] : table.entries)
    if (key.ends_with(kMrptPose)) return key.substr(0, key.size() - kMrptPose.size());
  return std::nullopt;
}

/// Where the right camera is in the frame of the left one: x y z, then a quaternion whose real part comes first.
Pose mrpt_pose(const NumberTable& table, const std::string& key, CalibrationNotes& notes) {
  constexpr std::size_t kCount = 7;
  const auto& numbers = table.require(key, kCount);
  NumberTable quaternion{table.source, {}};
  quaternion.entries[key].numbers.assign(numbers.begin() + 3, numbers.end());
  const Pose left_from_right{rotation_of(quaternion, key, notes), {numbers[0], numbers[1], numbers[2]}};
  return inverse(left_from_right);
}

/// Without its coefficients.
RawCamera camera_at(const NumberTable& table, const std::string& prefix, const char* column, const char* row,
                    Lens lens) {
  const auto number = [&](const std::string& name) { return table.require_number(prefix + name); };
  return {camera_matrix(number("fx"), number("fy"), number(column), number(row)), {}, lens};
}

Calibration read_mrpt(const NumberTable& table, const CalibrationRequest& request) {
  const std::string sections = *mrpt_sections(table);
  const std::string left = sections + "_LEFT.", right = sections + "_RIGHT.", pose = sections + std::string(kMrptPose);
  const ImageSize size = size_of_list(table, left + "resolution");
  check_same_size(size, size_of_list(table, right + "resolution"), table.source, right + "resolution");
  CalibrationNotes notes;
  const Lens lens = named_lens(table, notes);
  RawPair pair{{size.width_px, size.height_px, camera_at(table, left, "cx", "cy", lens),
                camera_at(table, right, "cx", "cy", lens)},
               left.substr(0, left.size() - 1),
               right.substr(0, right.size() - 1),
               pose,
               std::move(notes)};
  pair.stereo.left.distortion = distortion_of(table, left, lens);
  pair.stereo.right.distortion = distortion_of(table, right, lens);
  set_pose(pair.stereo, mrpt_pose(table, pose, pair.notes));
  return calibration_from_pair(std::move(pair), request, table.source);
}

/// Cameras whose centre of the image stands under the same names.
struct NamedCameras {
  const char *column = "cx", *row = "cy";
  std::vector<std::string> names;                          ///< what their keys begin with, less the dot
  std::vector<std::pair<std::string, std::string>> pairs;  ///< left and right, of these
};

NamedCameras cameras_with(const NumberTable& table, const char* column, const char* row) {
  NamedCameras found{column, row, {}, {}};
  const std::string end = std::string(".") + column;
  for (const auto& [key, entry] : table.entries) {
    if (!key.ends_with(end)) continue;
    const std::string name = key.substr(0, key.size() - end.size());
    if (table.has(name + ".fx") && table.has(name + ".fy")) found.names.push_back(name);
  }
  for (const auto& left : found.names)
    for (const auto& right : found.names)
      if (is_left_and_right(left, right)) found.pairs.emplace_back(left, right);
  return found;
}

/// Those that a pair is among; two or more others where there is none. Numbers beside them say more than other cameras.
std::optional<NamedCameras> named_cameras(const NumberTable& table) {
  const std::array found = {cameras_with(table, "ppx", "ppy"), cameras_with(table, "cx", "cy")};
  for (const auto& cameras : found)
    if (!cameras.pairs.empty()) return cameras;
  for (const auto& cameras : found)
    if (cameras.names.size() > 1 && !table.has("fx")) return cameras;
  return std::nullopt;
}

std::pair<std::string, std::string> pair_of(const NamedCameras& cameras, const std::string& source) {
  if (cameras.pairs.size() == 1) return cameras.pairs[0];
  throw InputError(source, "cameras",
                   fmt::format("found {}, expected {} whose names differ in left and right, l and r, or a number and "
                               "the next, as infra1 and infra2",
                               fmt::join(cameras.names, ", "), cameras.pairs.empty() ? "two" : "only two"));
}

/// The file less what it says of other cameras than these two.
NumberTable of_pair(NumberTable table, const NamedCameras& cameras, const std::pair<std::string, std::string>& pair) {
  const auto is_of = [](const std::string& key, const std::string& name) { return key.starts_with(name + "."); };
  std::erase_if(table.entries, [&](const auto& item) {
    const std::string& key = item.first;
    return !is_of(key, pair.first) && !is_of(key, pair.second) &&
           std::ranges::any_of(cameras.names, [&](const auto& name) { return is_of(key, name); });
  });
  return table;
}

/// From the left to the right camera; where the file says the distance too, both must agree.
struct FoundPose {
  Pose pose;
  std::string key;
};

/// RealSense's rotations stand column by column.
constexpr const char* kTranslation = "extrinsics.translation";
/// Stereolabs' transform is the pose of the right camera in the frame of the left one.
constexpr std::string_view kStereoTransform = "stereo_transform";

std::optional<std::string> key_of_stereo_transform(const NumberTable& table) {
  for (const auto& [key, entry] : table.entries)
    if (key.ends_with(kStereoTransform) && entry.numbers.size() == 16) return key;
  return std::nullopt;
}

/// In the unit that the file names, or else that its length tells.
Pose stereo_transform(const NumberTable& table, const std::string& key, CalibrationNotes& notes) {
  const Pose left_from_right = pose_of(table, key, notes);
  const bool is_millimetres = are_millimetres(left_from_right.translation);
  const auto unit = unit_of(table, key);
  if (!unit && is_millimetres)
    notes.push_back({key + " is taken as millimetres, as in the ZED SDK (correct it with --baseline M)"});
  return inverse(scaled(left_from_right, unit.value_or(is_millimetres ? 1e-3 : 1.0)));
}

/// What the file says of rotation and translation; nothing when it does not.
/// @param right what the keys of the right camera begin with
std::optional<FoundPose> pose_in(const NumberTable& file, const std::string& right, CalibrationNotes& notes) {
  const NumberTable table = with_listed_translation(file);
  for (const auto& place : {std::string(), right}) {
    if (!table.has(place + kTranslation)) continue;
    const auto& t = table.require(place + kTranslation, 3);
    const Pose pose{transposed(matrix_of(table, place + "extrinsics.rotation")), {t[0], t[1], t[2]}};
    // Else from right to left.
    return FoundPose{pose.translation[0] > 0.0 ? inverse(pose) : pose, place + kTranslation};
  }
  if (const auto key = key_of_stereo_transform(table)) return FoundPose{stereo_transform(table, *key, notes), *key};
  const OpenCvNames names = opencv_names(table);
  const auto in_metres = [&](const Pose& pose, const std::string& key) {
    return FoundPose{scaled(pose, unit_of(table, key).value_or(1.0)), key};
  };
  if (!names.pose.empty()) return in_metres(pose_of(table, names.pose, notes), names.pose);
  if (!table.has(names.translation)) return std::nullopt;
  const auto& t = table.require(names.translation, 3);
  return in_metres({rotation_of(table, names.rotation, notes), {t[0], t[1], t[2]}}, names.translation);
}

/// @param beside what does not stand below the keys of the cameras
/// @param right what those of the right one begin with
Pose dumped_pose(const NumberTable& table, const NumberTable& beside, const std::string& right, double fx_px,
                 const CalibrationRequest& request, CalibrationNotes& notes) {
  const auto pose = pose_in(table, right, notes);
  const auto baseline = baseline_in(beside, fx_px);
  const auto& t = pose ? pose->pose.translation : std::array<double, 3>{};
  if (pose && baseline && !request.baseline_m)
    check_same_length(*baseline, {pose->key, std::hypot(t[0], t[1], t[2])}, table.source);
  if (pose) return pose->pose;
  if (!baseline) {
    missing_baseline(request, table.source, "baseline (or R and T, or extrinsics.rotation and extrinsics.translation)");
    check_asked_baseline(*request.baseline_m, table.source);
  }
  return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {-(baseline ? baseline->value : *request.baseline_m), 0.0, 0.0}};
}

/// What stands before the key that fx stands below: "left." of "left.intrinsics.", and "" of "left.".
std::string place_around(const std::string& camera) {
  const auto dot = camera.rfind('.', camera.size() - 2);
  return dot == std::string::npos ? "" : camera.substr(0, dot + 1);
}

/// The coefficients of a camera: beside fx; beside the key that fx stands below, if that is of this camera alone; or
/// under OpenCV's names.
/// @param cameras what the keys of left and right begin with
std::vector<double> dumped_distortion(const NumberTable& table, const std::array<std::string, 2>& cameras,
                                      std::size_t side, Lens lens) {
  std::vector<std::string> places = {cameras[side]};
  if (place_around(cameras[0]) != place_around(cameras[1])) places.push_back(place_around(cameras[side]));
  for (const auto& place : places)
    if (auto found = distortion_below(table, place, lens); !found.key.empty()) return found.coefficients;
  const std::string key = opencv_names(table).distortions[side];
  if (table.has(key)) return distortion_at(table, key, lens).coefficients;
  for (const auto& place : places) check_no_distortion(table, place);
  check_no_distortion(table, "");
  return {};
}

/// Of the camera; or of both, beside them.
ImageSize dumped_size(const NumberTable& table, const std::string& camera, const NumberTable& beside,
                      const SizeQuery& query) {
  const auto size = size_in(below(table, camera), query);
  return size.width_px > 0 ? size : size_in(beside, query);
}

/// That other cameras are left out: a doubt where the pose does not say which of all it is between.
CalibrationNote note_on_others(const NamedCameras& cameras, const RawPair& pair, bool has_pose) {
  return {fmt::format("{} and {} are taken of the cameras {}{}", pair.left_key, pair.right_key,
                      fmt::join(cameras.names, ", "), has_pose ? ", and extrinsics as the pose between these two" : ""),
          has_pose ? CalibrationNoteKind::doubt : CalibrationNoteKind::told};
}

Calibration read_two_cameras(const NumberTable& whole, const CalibrationRequest& request) {
  const NamedCameras cameras = *named_cameras(whole);
  const auto names = pair_of(cameras, whole.source);
  const NumberTable table = of_pair(whole, cameras, names);
  const std::string left = names.first + ".", right = names.second + ".";
  NumberTable beside = table;
  std::erase_if(beside.entries,
                [&](const auto& item) { return item.first.starts_with(left) || item.first.starts_with(right); });
  const SizeQuery query{cameras.column, table.require_number(left + cameras.column),
                        table.require_number(left + cameras.row), request.calibrated_width_px,
                        request.calibrated_height_px};
  const ImageSize size = dumped_size(table, left, beside, query);
  check_same_size(size, dumped_size(table, right, beside, query), table.source, right + "width");
  CalibrationNotes notes;
  const Lens lens = named_lens(table, notes);
  RawPair pair{{size.width_px, size.height_px, camera_at(table, left, cameras.column, cameras.row, lens),
                camera_at(table, right, cameras.column, cameras.row, lens)},
               names.first,
               names.second,
               "extrinsics",
               std::move(notes)};
  pair.stereo.left.distortion = dumped_distortion(table, {left, right}, 0, lens);
  pair.stereo.right.distortion = dumped_distortion(table, {left, right}, 1, lens);
  const double fx_px = pair.stereo.left.matrix[0];
  set_pose(pair.stereo, dumped_pose(table, beside, right, fx_px, request, pair.notes));
  if (cameras.names.size() > 2)
    pair.notes.push_back(note_on_others(cameras, pair, beside.has(kTranslation) && !baseline_in(beside, fx_px)));
  return calibration_from_pair(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kMrpt{"MRPT stereo camera", false, false,
                              [](const NumberTable& table) { return mrpt_sections(table).has_value(); }, read_mrpt};

const CalibrationFormat kTwoCameras{"two cameras with fx, fy, ppx, ppy", false, false,
                                    [](const NumberTable& table) { return named_cameras(table).has_value(); },
                                    read_two_cameras};

}  // namespace flies::detail
