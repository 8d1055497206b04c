// Rectified cameras as people write them down by hand: one camera, the baseline and the size, under whichever names.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "flies/core/error.hpp"
#include "flies/core/plausible.hpp"
#include "flies/io/calibration_formats.hpp"
#include "flies/io/formats/cross_checks.hpp"
#include "flies/io/formats/distortion_names.hpp"
#include "flies/io/formats/lens_names.hpp"
#include "flies/io/formats/nesting.hpp"
#include "flies/io/formats/opencv_names.hpp"
#include "flies/io/formats/quantities.hpp"
#include "flies/io/formats/stated_size.hpp"

namespace flies::detail {
namespace {

bool has_lens(const NumberTable& table) {
  return std::ranges::any_of(table.entries, [](const auto& item) { return holds_distortion(item.first, item.second); });
}

/// The model of a lens that a file names and that rectified images do not have.
std::string word_for_lens(const NumberTable& table) {
  for (const auto& [key, entry] : table.entries)
    if (const auto lens = known_lens(table.word(key)); lens && *lens != Lens::brown) return table.word(key);
  return "";
}

/// One camera alone, as calibrateCamera leaves it, is half of a calibration.
[[noreturn]] void throw_one_camera(const std::string& source, const std::string& key) {
  throw InputError(source, key,
                   "describes one camera: the other one, and R and T between them, are missing (stereoCalibrate gives "
                   "all of them); for rectified images --baseline M is enough");
}

/// A file that says of one camera below no other key: without what stands below keys that hold cameras of their own.
NumberTable less_other_cameras(NumberTable table) {
  const auto is_on_top = [](const std::string& key) { return key.find('.') == std::string::npos; };
  NumberTable on_top{table.source, {}};
  std::set<std::string> groups;
  for (const auto& [key, entry] : table.entries)
    if (is_on_top(key))
      on_top.entries.emplace(key, entry);
    else
      groups.insert(key.substr(0, key.find('.') + 1));
  if (!has_camera(on_top)) return table;
  for (const auto& group : groups)
    if (has_camera(below(table, group)))
      std::erase_if(table.entries, [&](const auto& item) { return item.first.starts_with(group); });
  return table;
}

double baseline_of(const NumberTable& table, const FoundCamera& camera, const CalibrationRequest& request) {
  if (const auto baseline = baseline_in(table, camera.fx_px)) return baseline->value;
  if (has_lens(table) && !request.baseline_m) throw_one_camera(table.source, camera.key);
  return missing_baseline(request, table.source, "baseline");
}

/// Whether a file says how two cameras stand to each other.
bool has_pose(const NumberTable& table) { return opencv_names(table).has_pose; }

/// One camera of two by OpenCV's names: what the other file has too gets the name of its side.
void add_side(const NumberTable& file, const NumberTable& other, const std::string& side, NumberTable& table,
              CalibrationNotes& notes) {
  for (const auto& [key, entry] : file.entries) {
    const auto same = other.entries.find(key);
    const bool is_in_both = same != other.entries.end();
    if (is_in_both) table.entries[key + side] = entry;
    if (!is_in_both || (same->second.numbers == entry.numbers && same->second.not_a_number == entry.not_a_number))
      table.entries.emplace(key, entry);
  }
  const FoundCamera camera = camera_in(file, notes);
  const auto matrix = camera_matrix(camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px);
  table.entries.erase(camera.key + side);
  table.entries["camera_matrix" + side].numbers.assign(matrix.begin(), matrix.end());
  if (!file.has("k1")) return;
  CalibrationNotes of_other_file;
  table.entries["D" + side].numbers = named_lens(file, of_other_file) == Lens::equidistant
                                          ? coefficients_of(file, "", {"k1", "k2", "k3", "k4"})
                                          : coefficients_of(file, "", {"k1", "k2", "p1", "p2", "k3"});
}

/// A file a camera, as calibrateCamera leaves them, and R and T in one of both.
Calibration read_file_a_camera(const NumberTable& left, const CalibrationRequest& request) {
  const NumberTable right = less_other_cameras(read_number_table(request.right_path));
  CalibrationNotes notes;
  const bool is_complete = baseline_in(left, camera_in(left, notes).fx_px) && !has_pose(left) && !has_pose(right);
  if (is_complete || !has_camera(right))
    throw InputError(request.right_path, "right calibration",
                     fmt::format("is not used: {} describes {}", left.source,
                                 is_complete ? "a rectified pair completely in one file"
                                             : "one camera, and this file not the other one"));
  NumberTable table{left.source + " with " + right.source, {}};
  notes.clear();
  add_side(left, right, "_left", table, notes);
  add_side(right, left, "_right", table, notes);
  if (!has_pose(table) && has_pose(left) && has_pose(right))
    throw InputError(right.source, "R, T",
                     fmt::format("say something else than those in {}: expected them once, from the left camera to the "
                                 "right one, as stereoCalibrate gives them",
                                 left.source));
  if (!has_pose(table) && (has_lens(left) || has_lens(right) || !request.baseline_m))
    throw InputError(table.source, "R, T",
                     "are missing: two raw cameras need how they stand to each other, as stereoCalibrate gives it; "
                     "--baseline M is enough for rectified images alone, whose lenses have no distortion");
  const auto size_of = [&](const NumberTable& file) {
    const FoundCamera camera = camera_in(file, notes);
    return size_in(file,
                   {camera.key, camera.cx_px, camera.cy_px, request.calibrated_width_px, request.calibrated_height_px});
  };
  check_same_size(size_of(left), size_of(right), right.source, "image size");
  CalibrationRequest of_one_file = request;
  of_one_file.right_path.clear();
  auto calibration = kOpenCvStereo.read(table, of_one_file);
  calibration.notes.insert(calibration.notes.begin(), notes.begin(), notes.end());
  calibration.format = kOpenCvStereo.name;
  return calibration;
}

/// A translation beside the baseline is that of the right camera, as stereoCalibrate gives it, unless it goes elsewhere
/// than to the side, as to a place on the vehicle.
void note_translation(const NumberTable& table, double baseline_m, const CalibrationRequest& request,
                      CalibrationNotes& notes) {
  const OpenCvNames names = opencv_names(table);
  const auto found = table.entries.find(names.translation);
  constexpr std::size_t kCount = 3;
  if (found == table.entries.end() || found->second.numbers.size() != kCount) return;
  const auto& t = found->second.numbers;
  constexpr double kMostSlant = 0.1;
  if (std::hypot(t[1], t[2]) > kMostSlant * std::abs(t[0])) return;
  const double unit = known_unit_of(table, names.translation).value_or(1.0);
  note_other_baseline({"baseline", baseline_m}, length_of(names.translation, scaled({{}, {t[0], t[1], t[2]}}, unit)),
                      request, notes);
}

/// @throws InputError when the focal length is in another unit than pixels, by the name that the file has for it
void check_focal_unit(const FoundCamera& camera, ImageSize size, const std::string& source) {
  StereoCamera checked;
  checked.fx_px = camera.fx_px;
  checked.fy_px = camera.fy_px;
  checked.cx_px = camera.cx_px;
  checked.width_px = size.width_px;
  constexpr double kFewest_px = 20.0;  // of the smallest images
  if (camera.fx_px > 0.0 && camera.fx_px < kFewest_px && camera.fy_px > 0.0)
    check_focal_length(checked, source, camera.key);
}

Calibration read_flat(const NumberTable& table, const CalibrationRequest& request) {
  Calibration calibration;
  const NumberTable own = less_other_cameras(table);
  if (!request.right_path.empty()) return read_file_a_camera(own, request);
  const FoundCamera found = camera_in(own, calibration.notes);
  auto& camera = calibration.camera;
  camera.fx_px = found.fx_px;
  camera.fy_px = found.fy_px;
  camera.cx_px = found.cx_px;
  camera.cx_right_px = found.cx_right_px;
  camera.cy_px = found.cy_px;
  camera.baseline_m = baseline_of(table, found, request);
  note_translation(own, camera.baseline_m, request, calibration.notes);
  const auto size =
      size_in(own, {found.key, found.cx_px, found.cy_px, request.calibrated_width_px, request.calibrated_height_px});
  check_focal_unit(found, size, table.source);
  camera.width_px = size.width_px;
  camera.height_px = size.height_px;
  calibration.left_name = calibration.right_name = found.key;
  if (has_lens(table))
    calibration.notes.push_back(
        {"the images are taken as rectified, and the distortion coefficients are ignored: for raw images both cameras "
         "must be in the file (OpenCV's M1, D1, M2, D2, R, T)"});
  else if (const auto word = word_for_lens(table); !word.empty())
    calibration.notes.push_back({fmt::format(
        "the images are taken as rectified, though the file says '{}': for raw images both cameras must be "
        "in the file, with their coefficients (OpenCV's M1, D1, M2, D2, R, T)",
        word)});
  return calibration;
}

/// The columns of intrinsic.txt behind frame and camera; one camera, as both are alike.
constexpr const char* kVirtualColumns[] = {"K[0,0]", "K[1,1]", "K[0,2]", "K[1,2]"};

Calibration read_virtual_kitti(const NumberTable& table, const CalibrationRequest& request) {
  const auto number = [&](std::size_t column) { return table.require_number(kVirtualColumns[column]); };
  Calibration calibration;
  auto& camera = calibration.camera;
  camera.fx_px = number(0);
  camera.fy_px = number(1);
  camera.cx_px = camera.cx_right_px = number(2);
  camera.cy_px = number(3);
  camera.baseline_m = missing_baseline(request, table.source, "baseline (0.532725 m in Virtual KITTI 2)");
  calibration.left_name = "camera 0";
  calibration.right_name = "camera 1";
  return calibration;
}

}  // namespace

const CalibrationFormat kFlat{"flat fx, fy, cx, cy, baseline", false, true, has_camera, read_flat};

const CalibrationFormat kVirtualKitti{"Virtual KITTI intrinsic.txt", false, false,
                                      [](const NumberTable& table) { return table.has(kVirtualColumns[0]); },
                                      read_virtual_kitti};

}  // namespace flies::detail
