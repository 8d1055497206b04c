#include "flies/io/formats/cross_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "flies/core/error.hpp"
#include "flies/io/calibration_formats.hpp"

namespace flies::detail {
namespace {

constexpr double kAlike = 0.02;  // of files that round, or scale for other images

bool are_alike(double one, double other) { return std::abs(one - other) <= kAlike * std::abs(other); }

/// Centimetres or millimetres beside metres.
bool differ_by_unit(double one, double other) {
  const double ratio = std::max(one, other) / std::min(one, other);
  return are_alike(ratio, 100.0) || are_alike(ratio, 1000.0);
}

/// Hand-made files and small programs have one principal point and this difference.
void apply_doffs(const NumberTable& table, Calibration& calibration) {
  const auto doffs = doffs_in(table);
  if (!doffs || calibration.format == kMiddlebury.name) return;
  if (calibration.rectifier) {
    if (doffs->value != 0.0)
      calibration.notes.push_back(
          {fmt::format("{} is ignored: it is of rectified images, and the cameras of this file are raw", doffs->key)});
    return;
  }
  constexpr double kAlike_px = 1.0;
  auto& camera = calibration.camera;
  const double right_px = camera.cx_px + doffs->value;
  const bool has_right = camera.cx_right_px != camera.cx_px;
  if (has_right && std::abs(camera.cx_right_px - right_px) > kAlike_px)
    throw InputError(table.source, doffs->key,
                     fmt::format("found {:.6g} px, but the principal points of left and right, at columns {:.6g} and "
                                 "{:.6g} px, differ by {:.6g} px: which is meant?",
                                 doffs->value, camera.cx_px, camera.cx_right_px, camera.cx_right_px - camera.cx_px));
  if (has_right || doffs->value == 0.0) return;
  camera.cx_right_px = right_px;
  calibration.notes.push_back(
      {fmt::format("cx of the right camera is {:.6g} px, cx of the left one plus {}", right_px, doffs->key),
       CalibrationNoteKind::told});
}

void note_calibration_error(const NumberTable& table, CalibrationNotes& notes) {
  constexpr double kMost_px = 2.0;  // good calibrations stay below half a pixel
  const auto error = calibration_error_in(table);
  if (!error || !(error->value > kMost_px)) return;
  notes.push_back(
      {fmt::format("{} says that the calibration misses the corners of its board by {:.3g} px, and good ones stay "
                   "below 1 px: rectification and ranges may be wrong; calibrate again",
                   error->key, error->value)});
}

}  // namespace

FoundNumber length_of(const std::string& key, const Pose& pose) {
  const auto& t = pose.translation;
  return {key, std::hypot(t[0], t[1], t[2])};
}

void note_other_baseline(const FoundNumber& used, const FoundNumber& other, const CalibrationRequest& request,
                         CalibrationNotes& notes) {
  const double used_m = std::abs(used.value), other_m = std::abs(other.value);
  if (request.baseline_m || !(used_m > 0.0) || !(other_m > 0.0)) return;
  if (are_alike(other_m, used_m) || differ_by_unit(other_m, used_m)) return;
  notes.push_back(
      {fmt::format("{} gives a baseline of {:.4g} m, {} one of {:.4g} m, which is used: is one of them of another "
                   "camera or calibration? All ranges are proportional to it (--baseline M overrides the file)",
                   other.key, other_m, used.key, used_m)});
}

void note_other_focal_length(const FoundNumber& used, const FoundNumber& other, CalibrationNotes& notes) {
  if (are_alike(other.value, used.value)) return;
  notes.push_back({fmt::format(
      "{} gives a focal length of {:.6g} px, {} one of {:.6g} px, which is used: is one of them of another "
      "camera, or of images of another size? All ranges are proportional to it",
      other.key, other.value, used.key, used.value)});
}

bool is_reprojection(const std::vector<double>& q) {
  constexpr double kZero = 1e-9;
  constexpr std::size_t kCount = 16, kZeros[] = {1, 2, 4, 6, 8, 9, 10, 12, 13};
  return q.size() == kCount && q[0] == 1.0 && q[5] == 1.0 && std::abs(q[14]) > kZero &&
         std::ranges::all_of(kZeros, [&](std::size_t i) { return std::abs(q[i]) <= kZero; });
}

void note_other_reprojection(const NumberTable& table, const std::string& key, const FoundNumber& baseline,
                             const FoundNumber* focal, const CalibrationRequest& request, CalibrationNotes& notes) {
  const auto found = table.entries.find(key);
  if (found == table.entries.end() || !is_reprojection(found->second.numbers)) return;
  const auto& q = found->second.numbers;
  note_other_baseline(baseline, {key, known_unit_of(table, key).value_or(1.0) / q[14]}, request, notes);
  if (focal != nullptr) note_other_focal_length(*focal, {key, q[11]}, notes);
}

void check_statements(const NumberTable& table, const CalibrationRequest& request, Calibration& calibration) {
  apply_doffs(table, calibration);
  for (const auto& baseline : named_baselines(table))
    note_other_baseline({"the rest of the file", calibration.camera.baseline_m}, baseline, request, calibration.notes);
  note_calibration_error(table, calibration.notes);
}

}  // namespace flies::detail
