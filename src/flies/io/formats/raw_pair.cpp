#include "flies/io/formats/raw_pair.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/plausible.hpp"
#include "flies/io/formats/distortion_names.hpp"
#include "flies/io/formats/raw_checks.hpp"

namespace flies::detail {
namespace {

/// The camera matrix of images that were resized.
void scale(RawCamera& camera, ImageScale by) {
  auto& m = camera.matrix;
  m[0] *= by.across;
  m[1] *= by.across;
  m[4] *= by.down;
  m[2] = scaled_centre_px(m[2], by.across);
  m[5] = scaled_centre_px(m[5], by.down);
}

/// The camera as one of rectified images: its matrix and the size of the pair.
StereoCamera rectified_of(const RawCamera& camera, const RawStereo& raw) {
  const auto& m = camera.matrix;
  StereoCamera result;
  result.fx_px = m[0];
  result.fy_px = m[4];
  result.cx_px = result.cx_right_px = m[2];
  result.cy_px = m[5];
  result.width_px = raw.width_px;
  result.height_px = raw.height_px;
  return result;
}

bool is_rectified(const RawStereo& raw) {
  constexpr double kRounding = 1e-5;
  const auto is_straight = [](const RawCamera& camera) {
    return camera.lens == Lens::brown && std::ranges::all_of(camera.distortion, [](double c) { return c == 0.0; });
  };
  const Pose none;
  bool is_level = std::abs(raw.translation_m[1]) < kRounding && std::abs(raw.translation_m[2]) < kRounding;
  for (std::size_t i = 0; i < none.rotation.size(); ++i)
    is_level = is_level && std::abs(raw.rotation[i] - none.rotation[i]) < kRounding;
  const auto &left = raw.left.matrix, &right = raw.right.matrix;
  return is_level && is_straight(raw.left) && is_straight(raw.right) && left[0] == right[0] && left[4] == right[4] &&
         left[5] == right[5];
}

/// The size of a file without one: what the user said, what the principal point tells, or that of the images.
ImageSize size_of_unsized_pair(const RawPair& pair, const CalibrationRequest& request, const std::string& source,
                               CalibrationNotes& notes) {
  const RawStereo& raw = pair.stereo;
  if (request.calibrated_width_px > 0) return {request.calibrated_width_px, request.calibrated_height_px};
  if (request.images_are_resized)
    throw InputError(source, "image size",
                     "is not in the file: give the size that the images were resized from (--calib-size W,H)");
  if (request.width_px == 0 || request.height_px == 0)
    throw InputError(source, "image_width, image_height",
                     "are missing, but rectifying needs the size of the images: give it with --size W,H");
  const StereoCamera left = rectified_of(raw.left, raw);
  check_not_exchanged(left, request.width_px, request.height_px, source, pair.left_key);
  check_not_exchanged(rectified_of(raw.right, raw), request.width_px, request.height_px, source, pair.right_key);
  if (const auto deduced = size_of_unsized(left, request.width_px, request.height_px)) {
    notes.push_back({note_on_deduced_size(left.cx_px, left.cy_px, (*deduced)[0], (*deduced)[1])});
    return {(*deduced)[0], (*deduced)[1]};
  }
  check_size_of_unsized(left, request.width_px, request.height_px, source);
  check_camera_fits(left, request.width_px, request.height_px, source);
  return {request.width_px, request.height_px};
}

/// Sees to it that the pair has a size, not that of another camera, and not width for height.
void settle_size(RawPair& pair, const CalibrationRequest& request, const std::string& source) {
  RawStereo& raw = pair.stereo;
  CalibrationNotes& notes = pair.notes;
  if (raw.width_px == 0 || raw.height_px == 0) {
    const auto [width_px, height_px] = size_of_unsized_pair(pair, request, source, notes);
    raw.width_px = width_px;
    raw.height_px = height_px;
  }
  if (has_exchanged_size(rectified_of(raw.left, raw), request.width_px, request.height_px)) {
    std::swap(raw.width_px, raw.height_px);
    notes.push_back({note_on_exchanged_size(raw.width_px, raw.height_px)});
  }
  if (const StereoCamera left = rectified_of(raw.left, raw); is_of_other_size(left, request)) {
    notes.push_back(note_on_wrong_size(left, request.width_px, request.height_px));
    raw.width_px = request.width_px;
    raw.height_px = request.height_px;
  }
  check_said_size(raw.width_px, raw.height_px, request, source);
  check_not_padded(raw.width_px, raw.height_px, request, source);
}

/// What is improbable, and yet read, of the cameras.
CalibrationNotes notes_on(const RawPair& pair, const std::string& source) {
  const auto& raw = pair.stereo;
  CalibrationNotes notes;
  if (auto note = check_turn(raw.rotation, source, pair.pose_key); !note.empty()) notes.push_back({std::move(note)});
  for (const auto& [camera, key] : {std::pair{&raw.left, &pair.left_key}, std::pair{&raw.right, &pair.right_key}}) {
    const StereoCamera rectified = rectified_of(*camera, raw);
    for (const auto& note : check_focal_length(rectified, source, *key, camera->lens != Lens::brown))
      notes.push_back({*key + ": " + note});
    if (auto note = note_on_skew(*camera, *key); !note.empty()) notes.push_back({std::move(note)});
  }
  for (const auto& [camera, key] : {std::pair{&raw.left, &pair.left_key}, std::pair{&raw.right, &pair.right_key}})
    if (auto note = note_on_lens(*camera, *key, raw.width_px, raw.height_px); !note.empty()) {
      notes.push_back({std::move(note)});
      break;  // both have the same lens
    }
  for (const auto& [camera, key] : {std::pair{&raw.left, &pair.left_key}, std::pair{&raw.right, &pair.right_key}})
    if (auto note = note_on_fold(*camera, *key, raw.width_px, raw.height_px); !note.empty()) {
      notes.push_back({std::move(note)});
      break;
    }
  for (const auto& [camera, key] : {std::pair{&raw.left, &pair.left_key}, std::pair{&raw.right, &pair.right_key}})
    if (const auto note =
            check_principal_point(camera->matrix[2], camera->matrix[5], raw.width_px, raw.height_px, source, *key)) {
      notes.push_back({*key + ": " + *note});
      break;  // both were cropped alike, if they were
    }
  return notes;
}

/// Whether a file says nothing of the distortion of a lens that may have some; what Mei's model has of its own comes
/// first.
bool lacks_distortion(const RawCamera& camera) {
  return (camera.lens == Lens::brown && camera.distortion.empty()) ||
         (camera.lens == Lens::mei && camera.distortion.size() == 1);
}

/// Notes that neither camera has coefficients.
/// @throws InputError when only one of them has: who wrote or copied the file lost those of the other
void check_both_have_distortion(RawPair& pair, const std::string& source) {
  const RawCamera &left = pair.stereo.left, &right = pair.stereo.right;
  const auto is_bent = [](const RawCamera& camera) {
    return !lacks_distortion(camera) && std::ranges::any_of(camera.distortion, [](double c) { return c != 0.0; });
  };
  const auto refuse = [&](const std::string& lacking, const std::string& other) {
    throw InputError(source, lacking,
                     fmt::format("has no distortion coefficients, and {} has some: expected those of both cameras "
                                 "(zeros for a lens that bends nothing)",
                                 other));
  };
  if (lacks_distortion(right) && is_bent(left)) refuse(pair.right_key, pair.left_key);
  if (lacks_distortion(left) && is_bent(right)) refuse(pair.left_key, pair.right_key);
  if (!lacks_distortion(left) || !lacks_distortion(right)) return;
  const auto note = note_on_missing_distortion();
  if (std::ranges::find(pair.notes, note) == pair.notes.end()) pair.notes.push_back(note);
}

/// Coefficients that are left out are 0.
void complete_distortion(RawPair& pair) {
  constexpr std::size_t kAll = 5, kRadial = 2, kFewest = 4;
  for (RawCamera* camera : {&pair.stereo.left, &pair.stereo.right}) {
    auto& d = camera->distortion;
    if (camera->lens != Lens::brown || (!d.empty() && d.size() != kRadial)) continue;
    if (d.size() == kRadial && camera == &pair.stereo.left)
      pair.notes.push_back(
          {pair.left_distortion() + " is read as a pair of radial coefficients, k1 and k2", CalibrationNoteKind::told});
    d.resize(d.empty() ? kAll : kFewest, 0.0);
  }
}

/// Whether the right camera is at the right of the left one, and both look the same way.
bool is_side_by_side(const Pose& right_from_left) {
  constexpr double kMostSlant = 0.1, kLeastCosine = 0.87;  // as of rectified cameras; 30 degrees
  const auto& t = right_from_left.translation;
  return t[0] < 0.0 && std::hypot(t[1], t[2]) < -kMostSlant * t[0] && right_from_left.rotation[8] > kLeastCosine;
}

/// What would put cameras side by side whose poses in the frame of a body do not; empty when nothing would.
std::string cause_in_body_poses(const RawPair& pair) {
  if (!pair.body_poses) return {};
  const auto& [left, right] = *pair.body_poses;
  if (const Pose turned_round = chained(right, inverse(left)); is_side_by_side(turned_round))
    return fmt::format(
        "{}: the poses of both cameras seem to be the inverse ones: inverted, they put the cameras side by side, "
        "{:.4g} m apart",
        pair.pose_key, -turned_round.translation[0]);
  for (const bool is_left : {true, false}) {
    const Pose one = is_left ? scaled(left, 1e-3) : left, other = is_left ? right : scaled(right, 1e-3);
    if (is_side_by_side(chained(inverse(other), one)))
      return fmt::format(
          "{}: the translation of the {} camera seems to be in millimetres, and that of the other one in metres",
          pair.pose_key, is_left ? "left" : "right");
  }
  return {};
}

/// What most often makes two cameras see nothing in common; empty when neither size nor unit is odd.
std::string cause_of_failure(const RawPair& pair) {
  constexpr double kAlike = 1.4, kLeastBaseline_m = 0.005, kFarthest = 0.25;
  const RawStereo& raw = pair.stereo;
  if (auto cause = cause_in_body_poses(pair); !cause.empty()) return cause;
  const double left_px = raw.left.matrix[0], right_px = raw.right.matrix[0];
  const double apart_m = std::hypot(raw.translation_m[0], raw.translation_m[1], raw.translation_m[2]);
  if (std::max(left_px, right_px) > kAlike * std::min(left_px, right_px))
    return fmt::format(
        "the focal lengths of {} and {} are {:.6g} and {:.6g} px, expected nearly the same: is one of them for images "
        "of another size?",
        pair.left_key, pair.right_key, left_px, right_px);
  const double across = raw.left.matrix[2] / raw.width_px, down = raw.left.matrix[5] / raw.height_px;
  if (std::min(std::abs(across - 0.5), std::abs(down - 0.5)) > kFarthest)
    return fmt::format(
        "{}: the principal point ({:.1f}, {:.1f}) px is far from the middle of images of {} x {} px: is that their "
        "size, or are the numbers of the cameras those of other images?",
        pair.left_key, raw.left.matrix[2], raw.left.matrix[5], raw.width_px, raw.height_px);
  if (apart_m < kLeastBaseline_m)
    return fmt::format(
        "the cameras stand {:.4g} m apart ({}): is the translation, or one of its numbers, in another unit?", apart_m,
        pair.pose_key);
  return {};
}

/// @throws InputError with what was noted before, which often says why there is no rectification
Rectifier rectifier_of(const RawPair& pair, const std::string& source, const CalibrationNotes& notes) {
  try {
    return Rectifier(pair.stereo, source);
  } catch (const InputError& error) {
    const std::string message = error.what(), cause = cause_of_failure(pair);
    const std::string complaint = message.starts_with(source + ": ") ? message.substr(source.size() + 2) : message;
    if (!cause.empty()) throw InputError(source, "", fmt::format("{} ({})", cause, complaint));
    if (notes.empty()) throw;
    throw InputError(source, "", fmt::format("{}; {}", complaint, fmt::join(texts(notes), "; ")));
  }
}

}  // namespace

Calibration calibration_from_raw(RawPair pair, const CalibrationRequest& request, const std::string& source) {
  auto& raw = pair.stereo;
  check_both_have_distortion(pair, source);
  complete_distortion(pair);
  check_raw_pair(pair, source);
  settle_size(pair, request, source);
  Calibration calibration;
  calibration.notes = std::move(pair.notes);
  for (auto& note : notes_on(pair, source)) calibration.notes.push_back(std::move(note));
  const auto by = scale_to_images(raw.width_px, raw.height_px, request);
  if (by && (raw.width_px != request.width_px || raw.height_px != request.height_px)) {
    calibration.notes.push_back(note_on_scale(raw.width_px, raw.height_px, *by, request));
    scale(raw.left, *by);
    scale(raw.right, *by);
    raw.width_px = request.width_px;
    raw.height_px = request.height_px;
  }
  calibration.rectifier = rectifier_of(pair, source, calibration.notes);
  calibration.camera = calibration.rectifier->camera();
  calibration.left_name = pair.left_key;
  calibration.right_name = pair.right_key;
  const double share = calibration.camera.fx_px / calibration.camera.width_px;
  constexpr double kRounding = 1.01;
  if (share < kRounding * kWidestRectified)
    calibration.notes.push_back(
        {fmt::format(
             "the lenses see farther to the side than a rectified image can show: {:.0f} degrees of their view remain",
             2.0 * std::atan(0.5 / share) * 180.0 / std::numbers::pi),
         CalibrationNoteKind::told});
  calibration.notes.push_back(
      {fmt::format("the images are taken as raw and rectified first, with the {} model", lens_name(raw.left.lens)),
       CalibrationNoteKind::told});
  return calibration;
}

Calibration calibration_from_pair(RawPair pair, const CalibrationRequest& request, const std::string& source) {
  const RawStereo& raw = pair.stereo;
  if (!is_rectified(raw)) return calibration_from_raw(std::move(pair), request, source);
  Calibration calibration;
  calibration.notes = std::move(pair.notes);
  calibration.left_name = pair.left_key;
  calibration.right_name = pair.right_key;
  calibration.camera = rectified_of(raw.left, raw);
  calibration.camera.cx_right_px = raw.right.matrix[2];
  calibration.camera.baseline_m = -raw.translation_m[0];
  return calibration;
}

bool are_millimetres(std::span<const double> translation) {
  constexpr double kLeast = 10.0;
  return std::hypot(translation[0], translation[1], translation[2]) >= kLeast;
}

void set_pose(RawStereo& stereo, const Pose& right_from_left) {
  stereo.rotation = right_from_left.rotation;
  stereo.translation_m = right_from_left.translation;
}

void set_body_poses(RawPair& pair, const Pose& body_from_left, const Pose& body_from_right) {
  pair.body_poses = {body_from_left, body_from_right};
  set_pose(pair.stereo, chained(inverse(body_from_right), body_from_left));
}

std::array<double, 9> camera_matrix(double fx_px, double fy_px, double cx_px, double cy_px) {
  return {fx_px, 0.0, cx_px, 0.0, fy_px, cy_px, 0.0, 0.0, 1.0};
}

std::array<double, 9> matrix_of(const NumberTable& table, const std::string& key) {
  std::array<double, 9> values{};
  std::copy_n(table.require(key, values.size()).begin(), values.size(), values.begin());
  return values;
}

std::vector<double> coefficients_of(const NumberTable& table, const std::string& prefix,
                                    std::initializer_list<const char*> names, std::size_t least) {
  std::vector<double> values, padding;
  const bool has_any = std::ranges::any_of(names, [&](const char* name) { return table.has(prefix + name); });
  if (!has_any) return {};
  for (const char* name : names) {
    padding.push_back(table.has(prefix + name) ? table.require_number(prefix + name) : 0.0);
    if (table.has(prefix + name)) values = padding;
  }
  if (values.size() < least) values.resize(least, 0.0);
  return values;
}

ImageSize size_of_list(const NumberTable& table, const std::string& key) {
  constexpr std::size_t kShape = 3;  // of a NumPy array: rows, columns, colours
  const auto& found = table.require(key);
  const bool is_shape = found.size() == kShape && (found[2] == 1.0 || found[2] == 3.0 || found[2] == 4.0);
  const auto& size = is_shape ? found : table.require(key, 2);
  const auto pixels = [&](double number) {
    NumberTable one{table.source, {}};
    one.entries[key].numbers = {number};
    return one.require_size(key);
  };
  if (is_shape) return {pixels(size[1]), pixels(size[0])};
  return {pixels(size[0]), pixels(size[1])};
}

void check_same_size(ImageSize left, ImageSize right, const std::string& source, const std::string& key) {
  if (left.width_px == right.width_px && left.height_px == right.height_px) return;
  throw InputError(source, key,
                   fmt::format("found {} x {} px, expected {} x {} px as for the left camera", right.width_px,
                               right.height_px, left.width_px, left.height_px));
}

Pose pose_of_views(const RectifiedView& left, const RectifiedView& right) {
  // Both rectified frames have the same axes; the right one stands at -P[3] / fx, -P[7] / fy.
  Pose rectified;
  const auto apart = [&](std::size_t of_axis, std::size_t focal) {
    return right.projection[of_axis] / right.projection[focal] - left.projection[of_axis] / left.projection[focal];
  };
  rectified.translation = {apart(3, 0), apart(7, 5), 0.0};
  const Pose right_from_rectified{transposed(right.rotation), {}}, rectified_from_left{left.rotation, {}};
  return chained(right_from_rectified, chained(rectified, rectified_from_left));
}

}  // namespace flies::detail
