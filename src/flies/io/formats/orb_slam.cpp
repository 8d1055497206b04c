// Settings of ORB-SLAM2 and ORB-SLAM3: https://github.com/UZ-SLAMLab/ORB_SLAM3/blob/master/Calibration_Tutorial.pdf
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flies/core/error.hpp"
#include "flies/io/formats/cross_checks.hpp"
#include "flies/io/formats/distortion_names.hpp"
#include "flies/io/formats/opencv_names.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

ImageSize size_of(const NumberTable& table) {
  if (!table.has("Camera.width") && !table.has("Camera.height")) return {};
  return {table.require_size("Camera.width"), table.require_size("Camera.height")};
}

/// @param prefix "Camera.", "Camera1." or "Camera2."
RawCamera read_camera(const NumberTable& table, const std::string& prefix, Lens lens) {
  const auto number = [&](const char* name) { return table.require_number(prefix + name); };
  return {camera_matrix(number("fx"), number("fy"), number("cx"), number("cy")),
          distortion_below(table, prefix, lens).coefficients, lens};
}

/// Metres of `Stereo.b`, or of the older `Camera.bf`, focal length times metres. A file that has both is a copy of one
/// of them.
double baseline_of(const NumberTable& table, double fx_px, const CalibrationRequest& request, CalibrationNotes& notes) {
  const bool has_b = table.has("Stereo.b"), has_bf = table.has("Camera.bf");
  if (!has_b && !has_bf) return missing_baseline(request, table.source, "Camera.bf");
  if (!has_bf) return table.require_number("Stereo.b");
  const double by_bf_m = table.require_number("Camera.bf") / fx_px;
  if (!has_b) return by_bf_m;
  constexpr double kRounding = 0.02;
  const double b_m = table.require_number("Stereo.b");
  if (std::abs(by_bf_m - b_m) > kRounding * std::abs(b_m))
    notes.push_back(
        {fmt::format("Camera.bf gives a baseline of {:.4g} m, Stereo.b one of {:.4g} m, which is used: is one of them "
                     "of another camera, or of images of another size?",
                     by_bf_m, b_m)});
  return b_m;
}

/// Images that are rectified already: one camera and a baseline.
Calibration read_rectified(const NumberTable& table, const std::string& prefix, const CalibrationRequest& request) {
  const RawCamera raw = read_camera(table, prefix, Lens::brown);
  Calibration calibration;
  auto& camera = calibration.camera;
  camera.fx_px = raw.matrix[0];
  camera.fy_px = raw.matrix[4];
  camera.cx_px = camera.cx_right_px = raw.matrix[2];
  camera.cy_px = raw.matrix[5];
  if (camera.fx_px == 0.0) throw InputError(table.source, prefix + "fx", "found 0, expected a focal length");
  camera.baseline_m = baseline_of(table, camera.fx_px, request, calibration.notes);
  const auto size = size_of(table);
  camera.width_px = size.width_px;
  camera.height_px = size.height_px;
  calibration.left_name = calibration.right_name = prefix + "fx";
  if (std::any_of(raw.distortion.begin(), raw.distortion.end(), [](double d) { return d != 0.0; }))
    calibration.notes.push_back(
        {"the images are taken as rectified because the file has a baseline and no pose of the right camera; its "
         "coefficients of distortion are ignored",
         CalibrationNoteKind::told});
  if (opencv_names(table).has_matrices)
    calibration.notes.push_back(
        {"the images are taken as rectified, as Camera.fx and Camera.bf are; the file also holds camera matrices of "
         "raw cameras, which are ignored",
         CalibrationNoteKind::told});
  return calibration;
}

/// ORB-SLAM2 of raw images: how each of them is rectified.
RectifiedView read_view(const NumberTable& table, const std::string& side, CalibrationNotes& notes) {
  RectifiedView view;
  view.camera.matrix = matrix_of(table, side + ".K");
  view.camera.distortion = table.require(side + ".D");
  view.rotation = rotation_of(table, side + ".R", notes);
  view.projection = table.require(side + ".P", 12);
  if (view.projection[0] == 0.0 || view.projection[5] == 0.0)
    throw InputError(table.source, side + ".P", "found a focal length of 0");
  return view;
}

/// ORB-SLAM2 takes of `P` what is left of its last column, and the baseline from `Camera.bf`.
void check_baselines(const NumberTable& table, const RectifiedView& left, RectifiedView& right,
                     CalibrationNotes& notes) {
  if (!table.has("Camera.bf") || !table.has("Camera.fx")) return;
  const double fx_px = table.require_number("Camera.fx"), by_bf_m = table.require_number("Camera.bf") / fx_px;
  double& last = right.projection[3];
  if (last == 0.0 && left.projection[3] == 0.0) last = -by_bf_m * right.projection[0];
  const double by_p_m = left.projection[3] / left.projection[0] - last / right.projection[0];
  constexpr double kRounding = 0.02;
  if (std::abs(by_bf_m - by_p_m) > kRounding * std::abs(by_p_m))
    notes.push_back(
        {fmt::format("Camera.bf gives a baseline of {:.4g} m, LEFT.P and RIGHT.P one of {:.4g} m, which is used: are "
                     "they of another camera?",
                     by_bf_m, by_p_m)});
}

ImageSize size_of_views(const NumberTable& table) {
  if (!table.has("LEFT.width")) return size_of(table);
  const ImageSize left{table.require_size("LEFT.width"), table.require_size("LEFT.height")};
  if (const ImageSize both = size_of(table);
      both.width_px > 0 && (both.width_px != left.width_px || both.height_px != left.height_px))
    throw InputError(table.source, "LEFT.width, LEFT.height",
                     fmt::format("found {} x {} px, and Camera.width, Camera.height say {} x {}: LEFT and RIGHT are of "
                                 "another camera, or of images of another size",
                                 left.width_px, left.height_px, both.width_px, both.height_px));
  return left;
}

Calibration read_views(const NumberTable& table, const CalibrationRequest& request) {
  RawPair pair{{}, "LEFT.K", "RIGHT.K", "LEFT.R, RIGHT.R"};
  const auto left = read_view(table, "LEFT", pair.notes);
  auto right = read_view(table, "RIGHT", pair.notes);
  check_baselines(table, left, right, pair.notes);
  pair.stereo.left = left.camera;
  pair.stereo.right = right.camera;
  set_pose(pair.stereo, pose_of_views(left, right));
  const auto size = size_of_views(table);
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  return calibration_from_raw(std::move(pair), request, table.source);
}

/// @param left what the keys of the left camera begin with
/// @throws InputError when coefficients stand where they are not read, as those of older settings do: below Camera
void check_all_distortion_is_read(const NumberTable& table, const RawStereo& stereo, const std::string& left) {
  if (!stereo.left.distortion.empty() && !stereo.right.distortion.empty()) return;
  if (stereo.left.distortion.empty()) check_no_distortion(table, left);
  if (stereo.right.distortion.empty()) check_no_distortion(table, "Camera2.");
  const auto older = distortion_below(table, "Camera.", stereo.left.lens);
  if (left == "Camera." || older.key.empty()) return;
  if (std::ranges::any_of(older.coefficients, [](double c) { return c != 0.0; }))
    throw InputError(table.source, older.key,
                     "stands beside Camera1.fx and Camera2.fx and does not say of which camera: expected Camera1.k1, "
                     "Camera2.k1, ...");
}

Calibration read_orb_slam(const NumberTable& table, const CalibrationRequest& request) {
  if (table.has("LEFT.K") || table.has("RIGHT.K")) return read_views(table, request);
  const bool is_third = table.has("Camera1.fx");
  const std::string left = is_third ? "Camera1." : "Camera.", type = table.word("Camera.type");
  const std::string pose_key = table.has("Stereo.T_c1_c2") ? "Stereo.T_c1_c2" : "Tlr";
  if (type == "rectified" || !table.has(pose_key)) return read_rectified(table, left, request);
  const Lens lens = lens_of(type, "Camera.type", table.source);
  RawPair pair{{}, left + "fx", "Camera2.fx", pose_key};
  pair.stereo.left = read_camera(table, left, lens);
  pair.stereo.right = read_camera(table, "Camera2.", lens);
  check_all_distortion_is_read(table, pair.stereo, left);
  const Pose pose = inverse(pose_of(table, pose_key, pair.notes));
  set_pose(pair.stereo, pose);
  if (const auto b = table.entries.find("Stereo.b"); b != table.entries.end() && b->second.numbers.size() == 1)
    note_other_baseline(length_of(pose_key, pose), {"Stereo.b", b->second.numbers[0]}, request, pair.notes);
  const auto size = size_of(table);
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  return calibration_from_raw(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kOrbSlam{
    "ORB-SLAM settings", false, false,
    [](const NumberTable& table) { return table.has("Camera.fx") || table.has("Camera1.fx"); }, read_orb_slam};

}  // namespace flies::detail
