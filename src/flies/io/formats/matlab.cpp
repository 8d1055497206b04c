// MATLAB's stereoParameters, written with jsonencode(toStruct(params)) or as YAML with the same names:
// https://www.mathworks.com/help/vision/ref/stereoparameters.html, .../stereoparameterstoopencv.html
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/formats/cross_checks.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

/// Of a struct, and of an object whose intrinsics are one of their own. The matrix is there where the coefficients are
/// missing.
constexpr std::array<std::string_view, 6> kFirstCamera = {"CameraParameters1.RadialDistortion",
                                                          "CameraParameters1.Intrinsics.RadialDistortion",
                                                          "CameraParameters1.IntrinsicMatrix",
                                                          "CameraParameters1.Intrinsics.IntrinsicMatrix",
                                                          "CameraParameters1.K",
                                                          "CameraParameters1.Intrinsics.K"};

/// Of a fisheyeParameters: the key of the coefficients of its own model.
std::optional<std::string> key_of_mapping(const NumberTable& table) {
  for (const auto& [key, entry] : table.entries)
    if (key.substr(key.rfind('.') + 1) == "MappingCoefficients") return key;
  return std::nullopt;
}

/// What stands before the names: the file may hold the struct below a key of its own.
std::optional<std::string> prefix_of(const NumberTable& table) {
  for (const auto& [key, entry] : table.entries)
    for (const auto& end : kFirstCamera)
      if (key.ends_with(end)) return key.substr(0, key.size() - end.size());
  return std::nullopt;
}

/// What stands before the names of one camera.
std::string camera_of(const NumberTable& table, const std::string& prefix, int camera) {
  const std::string key = fmt::format("{}CameraParameters{}.", prefix, camera), inner = key + "Intrinsics.";
  const bool has_inner = std::ranges::any_of(std::array{"RadialDistortion", "IntrinsicMatrix", "K"},
                                             [&](const char* name) { return table.has(inner + name); });
  const auto has_radial = [&](const std::string& where) { return table.has(where + "RadialDistortion"); };
  return has_radial(inner) || (has_inner && !has_radial(key)) ? inner : key;
}

std::string matrix_key(const NumberTable& table, const std::string& camera) {
  for (const char* name : {"K", "FocalLength"})
    if (table.has(camera + name)) return camera + name;
  return camera + "IntrinsicMatrix";
}

/// Before 1 is subtracted, which hides it.
void check_not_transposed(const std::array<double, 9>& m, const std::string& source, const std::string& key) {
  if (m[2] != 0.0 || m[5] != 0.0 || !(m[6] > 1.0) || !(m[7] > 1.0)) return;
  throw InputError(source, key,
                   key.ends_with("K") ? "is transposed, expected fx 0 cx, 0 fy cy, 0 0 1, as MATLAB writes K: is it an "
                                        "IntrinsicMatrix?"
                                      : "is transposed, expected fx 0 0, 0 fy 0, cx cy 1, as MATLAB writes "
                                        "IntrinsicMatrix: is it a K?");
}

/// IntrinsicMatrix multiplies from the right: it is the transposed of K. Both count pixels from 1.
std::array<double, 9> read_matrix(const NumberTable& table, const std::string& camera) {
  const std::string key = matrix_key(table, camera);
  std::array<double, 9> m{};
  if (key.ends_with("FocalLength")) {
    const auto &focal = table.require(key, 2), &centre = table.require(camera + "PrincipalPoint", 2);
    m = camera_matrix(focal[0], focal[1], centre[0], centre[1]);
  } else {
    m = key.ends_with("K") ? matrix_of(table, key) : transposed(matrix_of(table, key));
    check_not_transposed(m, table.source, key);
  }
  m[2] -= 1.0;
  m[5] -= 1.0;
  return m;
}

/// Notes that the file says the focal length under another name too, and not the same.
void note_other_names(const NumberTable& table, const std::string& camera, double fx_px, CalibrationNotes& notes) {
  const std::string used = matrix_key(table, camera);
  for (const char* name : {"K", "FocalLength", "IntrinsicMatrix"}) {
    const auto other = table.entries.find(camera + name);
    if (other == table.entries.end() || other->first == used || other->second.numbers.size() < 2) continue;
    note_other_focal_length({used, fx_px}, {other->first, other->second.numbers[0]}, notes);
  }
}

RawCamera read_camera(const NumberTable& table, const std::string& camera) {
  const auto& radial = table.require(camera + "RadialDistortion");
  const auto& tangential = table.require(camera + "TangentialDistortion", 2);
  if (radial.size() != 2 && radial.size() != 3)
    throw InputError(table.source, camera + "RadialDistortion",
                     fmt::format("found {} numbers, expected 2 or 3", radial.size()));
  RawCamera raw;
  raw.matrix = read_matrix(table, camera);
  raw.distortion = {radial[0], radial[1], tangential[0], tangential[1], radial.size() == 3 ? radial[2] : 0.0};
  return raw;
}

double metres_per_unit(const NumberTable& table, const std::string& prefix) {
  std::string key = prefix + "WorldUnits";
  if (!table.has(key)) key = prefix + "CameraParameters1.WorldUnits";
  const std::string unit = table.word(key);
  if (unit == "millimeters" || unit == "mm" || unit.empty()) return 1e-3;
  if (unit == "centimeters" || unit == "cm") return 1e-2;
  if (unit == "meters" || unit == "m") return 1.0;
  if (unit == "inches" || unit == "in") return 0.0254;
  throw InputError(table.source, key,
                   fmt::format("found '{}', expected millimeters, centimeters, meters or inches", unit));
}

Pose read_pose(const NumberTable& table, const std::string& prefix, CalibrationNotes& notes) {
  const auto translation_of = [&](const std::string& key) {
    const auto& t = table.require(key, 3);
    return std::array{t[0], t[1], t[2]};
  };
  if (const std::string key = prefix + "RotationOfCamera2"; table.has(key)) {
    const auto rotation = rotation_of(table, key, notes);
    const bool is_matrix = table.require(key).size() == rotation.size();  // which multiplies from the right
    return {is_matrix ? transposed(rotation) : rotation, translation_of(prefix + "TranslationOfCamera2")};
  }
  const std::string pose_key = prefix + "PoseCamera2";
  if (table.has(pose_key + ".R"))
    return {rotation_of(table, pose_key + ".R", notes), translation_of(pose_key + ".Translation")};
  for (const char* name : {".A", ".T"})  // of rigidtform3d, and of rigid3d, which is transposed
    if (table.has(pose_key + name)) return pose_of(table, pose_key + name, notes);
  return pose_of(table, pose_key, notes);
}

/// Notes that PoseCamera2, which newer versions write, says another distance than TranslationOfCamera2.
void note_other_pose(const NumberTable& table, const std::string& prefix, const FoundNumber& used,
                     double metres_per_unit, const CalibrationRequest& request, CalibrationNotes& notes) {
  const auto other = table.entries.find(prefix + "PoseCamera2.Translation");
  constexpr std::size_t kCount = 3;
  if (!table.has(prefix + "RotationOfCamera2") || other == table.entries.end() ||
      other->second.numbers.size() != kCount)
    return;
  const auto& t = other->second.numbers;
  note_other_baseline(used, length_of(other->first, scaled({{}, {t[0], t[1], t[2]}}, metres_per_unit)), request, notes);
}

/// Rows and columns; the list is empty where nobody gave it.
ImageSize size_in_file(const NumberTable& table, const std::string& key) {
  const auto entry = table.entries.find(key);
  if (entry == table.entries.end() || (entry->second.numbers.empty() && entry->second.not_a_number.empty())) return {};
  const auto rows_columns = size_of_list(table, key);
  return {rows_columns.height_px, rows_columns.width_px};
}

Calibration read_matlab(const NumberTable& table, const CalibrationRequest& request) {
  if (const auto key = key_of_mapping(table))
    throw InputError(table.source, *key,
                     "is of MATLAB's fisheye model (Scaramuzza's), which is not read: calibrate with OpenCV's fisheye "
                     "model, or undistort the images in MATLAB and calibrate those");
  const std::string prefix = prefix_of(table).value_or("");
  const std::string left = camera_of(table, prefix, 1), right = camera_of(table, prefix, 2);
  RawPair pair{{}, matrix_key(table, left), matrix_key(table, right), prefix + "RotationOfCamera2"};
  pair.stereo.left = read_camera(table, left);
  pair.stereo.right = read_camera(table, right);
  note_other_names(table, left, pair.stereo.left.matrix[0], pair.notes);
  note_other_names(table, right, pair.stereo.right.matrix[0], pair.notes);
  const double unit = metres_per_unit(table, prefix);
  const Pose pose = scaled(read_pose(table, prefix, pair.notes), unit);
  set_pose(pair.stereo, pose);
  note_other_pose(table, prefix, length_of(prefix + "TranslationOfCamera2", pose), unit, request, pair.notes);
  const auto size = size_in_file(table, left + "ImageSize");
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  return calibration_from_raw(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kMatlab{
    "MATLAB stereoParameters", false, false,
    [](const NumberTable& table) { return prefix_of(table).has_value() || key_of_mapping(table).has_value(); },
    read_matlab};

}  // namespace flies::detail
