// Two cameras of a few keys each and what lies between them: MRPT's configurations, and what scripts dump of a
// RealSense or another stereo camera (JSON or YAML).
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/formats/raw_pair.hpp"

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

/// k1 k2 p1 p2 k3 of a camera; zeros where it names none.
std::vector<double> distortion_at(const NumberTable& table, const std::string& prefix) {
  if (table.has(prefix + "k1")) return coefficients_of(table, prefix, {"k1", "k2", "p1", "p2", "k3"});
  for (const char* name : {"coeffs", "dist", "distortion", "distortion_coefficients", "D"})
    if (table.has(prefix + name)) return table.require(prefix + name);
  return {};
}

RawCamera camera_at(const NumberTable& table, const std::string& prefix, const char* column, const char* row) {
  const auto number = [&](const std::string& name) { return table.require_number(prefix + name); };
  return {camera_matrix(number("fx"), number("fy"), number(column), number(row)), distortion_at(table, prefix)};
}

Calibration read_mrpt(const NumberTable& table, const CalibrationRequest& request) {
  const std::string sections = *mrpt_sections(table);
  const std::string left = sections + "_LEFT.", right = sections + "_RIGHT.", pose = sections + std::string(kMrptPose);
  const ImageSize size = size_of_list(table, left + "resolution");
  check_same_size(size, size_of_list(table, right + "resolution"), table.source, right + "resolution");
  RawPair pair{{size.width_px, size.height_px, camera_at(table, left, "cx", "cy"), camera_at(table, right, "cx", "cy")},
               left.substr(0, left.size() - 1),
               right.substr(0, right.size() - 1),
               pose};
  set_pose(pair.stereo, mrpt_pose(table, pose, pair.notes));
  return calibration_from_pair(std::move(pair), request, table.source);
}

/// What the keys of one camera begin with, of two: "infra1." and "infra2.", "left." and "right.". In the order of their
/// names the left one is first.
struct TwoPrefixes {
  std::string left, right;
  const char *column = "cx", *row = "cy";
};

std::optional<TwoPrefixes> two_prefixes(const NumberTable& table) {
  for (const auto& [column, row] : {std::array{"ppx", "ppy"}, std::array{"cx", "cy"}}) {
    const std::string end = std::string(".") + column;
    std::vector<std::string> found;
    for (const auto& [key, entry] : table.entries) {
      if (!key.ends_with(end)) continue;
      const std::string prefix = key.substr(0, key.size() - end.size() + 1);
      if (table.has(prefix + "fx") && table.has(prefix + "fy")) found.push_back(prefix);
    }
    if (found.size() == 2) return TwoPrefixes{found[0], found[1], column, row};
  }
  return std::nullopt;
}

constexpr std::array kBaselines = {"baseline", "baseline_m", "baseline_meters"};

/// RealSense's rotations stand column by column.
Pose dumped_pose(const NumberTable& table, const CalibrationRequest& request) {
  for (const char* name : kBaselines)
    if (table.has(name)) return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {-table.require_number(name), 0.0, 0.0}};
  if (!table.has("extrinsics.translation")) {
    missing_baseline(request, table.source, "baseline (or extrinsics.rotation and extrinsics.translation)");
    check_asked_baseline(*request.baseline_m, table.source);
    return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {-*request.baseline_m, 0.0, 0.0}};
  }
  const auto& t = table.require("extrinsics.translation", 3);
  const Pose pose{transposed(matrix_of(table, "extrinsics.rotation")), {t[0], t[1], t[2]}};
  return pose.translation[0] > 0.0 ? inverse(pose) : pose;  // from the right to the left camera
}

ImageSize dumped_size(const NumberTable& table, const std::string& prefix) {
  if (!table.has(prefix + "width") && !table.has(prefix + "height")) return {};
  return {table.require_size(prefix + "width"), table.require_size(prefix + "height")};
}

Calibration read_two_cameras(const NumberTable& table, const CalibrationRequest& request) {
  const TwoPrefixes names = *two_prefixes(table);
  const ImageSize size = dumped_size(table, names.left);
  check_same_size(size, dumped_size(table, names.right), table.source, names.right + "width");
  RawPair pair{{size.width_px, size.height_px, camera_at(table, names.left, names.column, names.row),
                camera_at(table, names.right, names.column, names.row)},
               names.left.substr(0, names.left.size() - 1),
               names.right.substr(0, names.right.size() - 1),
               "extrinsics"};
  set_pose(pair.stereo, dumped_pose(table, request));
  return calibration_from_pair(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kMrpt{"MRPT stereo camera", false, false,
                              [](const NumberTable& table) { return mrpt_sections(table).has_value(); }, read_mrpt};

const CalibrationFormat kTwoCameras{"two cameras with fx, fy, ppx, ppy", false, false,
                                    [](const NumberTable& table) { return two_prefixes(table).has_value(); },
                                    read_two_cameras};

}  // namespace flies::detail
