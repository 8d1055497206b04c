#include "flies/io/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/core/plausible.hpp"
#include "flies/io/calibration_formats.hpp"
#include "flies/io/formats/cross_checks.hpp"
#include "flies/io/number_table.hpp"

namespace flies {
namespace {

constexpr double kProbableHeight_m = 20.0;

/// What a height of that many metres may have been meant as.
std::string likely_unit(double height) {
  constexpr double kLow_m = 0.2, kHigh_m = 5.0;
  for (const auto& [unit, metres] : {std::pair{"centimetres", 1e-2}, std::pair{"millimetres", 1e-3}})
    if (const double height_m = height * metres; height_m >= kLow_m && height_m <= kHigh_m)
      return fmt::format("is it in {} ({:.3g} m)?", unit, height_m);
  return "check its unit";
}

/// @throws InputError naming what was said, not the file
void check_asked_mount(const CalibrationRequest& request) {
  CameraMount said;
  said.height_m = request.camera_height_m.value_or(said.height_m);
  said.pitch_rad = request.camera_pitch_rad.value_or(said.pitch_rad);
  said.roll_rad = request.camera_roll_rad.value_or(said.roll_rad);
  detail::check_mount(said, "given mount (--camera-height, --camera-pitch, --camera-roll)");
}

void apply_mount(const CalibrationRequest& request, Calibration& calibration) {
  check_asked_mount(request);
  auto& mount = calibration.camera.mount;
  mount.height_m = request.camera_height_m.value_or(mount.height_m);
  mount.pitch_rad = request.camera_pitch_rad.value_or(mount.pitch_rad);
  mount.roll_rad = request.camera_roll_rad.value_or(mount.roll_rad);
  calibration.has_height |= request.camera_height_m.has_value();
  calibration.has_pitch |= request.camera_pitch_rad.has_value();
  std::vector<std::string> missing, assumed, flags;
  const auto assume = [&](const char* what, std::string value, const char* flag) {
    missing.emplace_back(what);
    assumed.push_back(std::move(value));
    flags.emplace_back(flag);
  };
  if (!calibration.has_height) assume("height", fmt::format("{} m", mount.height_m), "--camera-height");
  if (!calibration.has_pitch) assume("pitch", fmt::format("{} degrees", degrees(mount.pitch_rad)), "--camera-pitch");
  if (mount.height_m > kProbableHeight_m)
    calibration.notes.push_back(
        {fmt::format("a camera height of {:.4g} m is improbable for a camera that looks along the road: {}",
                     mount.height_m, likely_unit(mount.height_m))});
  if (!missing.empty())
    calibration.notes.push_back(
        {fmt::format("the file gives no camera {}, assumed: {} (set with {})", fmt::join(missing, " and "),
                     fmt::join(assumed, " and "), fmt::join(flags, ", ")),
         CalibrationNoteKind::mount});
}

/// Images that are as wide as the calibration's and lower were cut off, by rows: no range depends on which. As long as
/// nobody says otherwise at the bottom, which leaves the principal point where it was; rows that are missing at the top
/// look like a camera that looks down, which the road tells.
bool was_cut_off(const CalibrationRequest& request, const Calibration& calibration, int width_px, int height_px) {
  return !request.images_are_resized && !calibration.rectifier && width_px == request.width_px &&
         height_px > request.height_px && height_px < 2 * request.height_px &&
         !detail::one_scale(width_px, height_px, request.width_px, request.height_px);
}

void take_as_cut_off(const CalibrationRequest& request, Calibration& calibration, int height_px) {
  const int rows = height_px - request.height_px;
  calibration.notes.push_back({fmt::format(
      "the calibration is for {} x {} px, and the images seem to be the upper {} rows of that: if {} rows were cut off "
      "at the top instead, the camera seems to look {:.1f} degrees down, which --mount auto finds from the road; if "
      "the images were squeezed, give --resized",
      request.width_px, height_px, request.height_px, rows, degrees(std::atan(rows / calibration.camera.fy_px)))});
  calibration.camera.width_px = request.width_px;
  calibration.camera.height_px = request.height_px;
}

/// Images of the calibration's width and half its height: fields of interlaced video, far likelier than a cut there.
bool was_squeezed(const CalibrationRequest& request, const Calibration& calibration, int width_px, int height_px) {
  return !request.images_are_resized && !calibration.rectifier && width_px == request.width_px && height_px > 2 &&
         std::abs(2 * request.height_px - height_px) <= 1;
}

void take_as_squeezed(const CalibrationRequest& request, Calibration& calibration, int height_px) {
  calibration.notes.push_back(
      {fmt::format("the calibration is for {} x {} px, and the images have half the rows: they are taken as squeezed, "
                   "like fields of interlaced video (--resized confirms that); if rows were cut off instead, the road "
                   "seems to lie twice as far below the camera as it does: then put the size of the images and cy less "
                   "the rows cut off at the top into the calibration, and give the height of the camera",
                   request.width_px, height_px)});
  const detail::ImageScale halved{1.0, static_cast<double>(request.height_px) / height_px};
  calibration.camera = detail::scaled_camera(calibration.camera, halved, request.width_px, request.height_px);
}

/// Images that lack rows: for a calibration of this size, which fits in no other way.
/// @returns whether they do, and the camera is theirs now
bool take_with_fewer_rows(const CalibrationRequest& request, Calibration& calibration, int width_px, int height_px) {
  if (was_squeezed(request, calibration, width_px, height_px))
    take_as_squeezed(request, calibration, height_px);
  else if (was_cut_off(request, calibration, width_px, height_px))
    take_as_cut_off(request, calibration, height_px);
  else
    return false;
  return true;
}

/// Before anything is held against the size. Raw cameras were looked at before they were rectified.
void correct_size(const CalibrationRequest& request, Calibration& calibration) {
  auto& camera = calibration.camera;
  if (calibration.rectifier) return;
  if (detail::has_exchanged_size(camera, request.width_px, request.height_px)) {
    std::swap(camera.width_px, camera.height_px);
    calibration.notes.push_back({detail::note_on_exchanged_size(camera.width_px, camera.height_px)});
  } else if (detail::is_of_other_size(camera, request)) {
    calibration.notes.push_back(detail::note_on_wrong_size(camera, request.width_px, request.height_px));
    camera.width_px = request.width_px;
    camera.height_px = request.height_px;
  }
}

/// The size that the calibration is for, as far as file and request say it or the principal point tells.
std::array<int, 2> calibrated_size(const StereoCamera& camera, const CalibrationRequest& request) {
  if (camera.width_px > 0) return {camera.width_px, camera.height_px};
  if (const auto deduced = detail::size_of_unsized(camera, request.width_px, request.height_px)) return *deduced;
  const auto inner = detail::inside(request.borders, {request.width_px, request.height_px});
  return detail::size_of_unsized(camera, inner.width_px, inner.height_px).value_or(std::array{0, 0});
}

/// Brings the camera to the size of the images: given where the file has none, scaled where one scale fits.
void fit_size(const CalibrationRequest& request, const std::string& source, Calibration& calibration) {
  auto& camera = calibration.camera;
  if (camera.width_px == 0 && request.calibrated_width_px > 0) {
    camera.width_px = request.calibrated_width_px;
    camera.height_px = request.calibrated_height_px;
  }
  if (!calibration.rectifier) detail::check_said_size(camera.width_px, camera.height_px, request, source);
  if (request.width_px <= 0 || request.height_px <= 0) return;
  if (camera.width_px == 0)
    detail::check_not_exchanged(camera, request.width_px, request.height_px, source, "principal point");
  if (request.borders.any()) {
    const auto [width_px, height_px] = calibrated_size(camera, request);
    detail::check_not_padded(width_px, height_px, request, source);
  }
  const auto deduced =
      camera.width_px == 0 ? detail::size_of_unsized(camera, request.width_px, request.height_px) : std::nullopt;
  if (deduced && take_with_fewer_rows(request, calibration, (*deduced)[0], (*deduced)[1])) return;
  if (deduced && (*deduced)[0] == request.height_px && (*deduced)[1] == request.width_px) {
    camera.width_px = (*deduced)[0];
    camera.height_px = (*deduced)[1];
    check_camera_fits(camera, request.width_px, request.height_px, source);
  }
  if (deduced && !detail::scale_to_images((*deduced)[0], (*deduced)[1], request))
    throw InputError(source, "image size",
                     fmt::format("is not in the file, whose numbers fit images of {} x {} px, not of {} x {} px: were "
                                 "the images padded or letterboxed (then cut that off), cropped, or resized by {:.3g} "
                                 "horizontally and {:.3g} vertically (then give --resized)? --calib-size W,H gives the "
                                 "size that the calibration is for",
                                 (*deduced)[0], (*deduced)[1], request.width_px, request.height_px,
                                 static_cast<double>(request.width_px) / (*deduced)[0],
                                 static_cast<double>(request.height_px) / (*deduced)[1]));
  if (deduced) {
    camera.width_px = (*deduced)[0];
    camera.height_px = (*deduced)[1];
    calibration.notes.push_back(
        {detail::note_on_deduced_size(camera.cx_px, camera.cy_px, camera.width_px, camera.height_px)});
  } else if (camera.width_px == 0 && request.images_are_resized) {
    throw InputError(source, "image size",
                     "is not in the file: give the size that the images were resized from (--calib-size W,H)");
  } else if (camera.width_px == 0) {
    detail::check_size_of_unsized(camera, request.width_px, request.height_px, source);
    check_camera_fits(camera, request.width_px, request.height_px, source);
    camera.width_px = request.width_px;
    camera.height_px = request.height_px;
  }
  if (camera.width_px == request.width_px && camera.height_px == request.height_px) return;
  if (take_with_fewer_rows(request, calibration, camera.width_px, camera.height_px)) return;
  const auto scale = detail::scale_to_images(camera.width_px, camera.height_px, request);
  if (!scale || calibration.rectifier) return;  // told where the images are used; raw cameras were scaled before
  calibration.notes.push_back(detail::note_on_scale(camera.width_px, camera.height_px, *scale, request));
  camera = detail::scaled_camera(camera, *scale, request.width_px, request.height_px);
}

/// After all that judges the file as it is.
void shift_disparities(const CalibrationRequest& request, Calibration& calibration) {
  const double shift_px = request.disparity_shift_px;
  if (shift_px == 0.0) return;
  auto& camera = calibration.camera;
  const double most_px = camera.width_px > 0 ? camera.width_px : 2.0 * camera.cx_px;
  if (!(std::abs(shift_px) < most_px))
    throw InputError("disparity shift", "--disparity-shift",
                     fmt::format("{} px was asked for, expected less than the image is wide, which is {:.0f} px",
                                 shift_px, most_px));
  camera.cx_right_px += shift_px;
  calibration.notes.push_back(
      {fmt::format(
           "all disparities are taken as {:.4g} px {} than the images show, as requested: cx of the right camera "
           "is {:.2f}",
           std::abs(shift_px), shift_px > 0.0 ? "larger" : "smaller", camera.cx_right_px),
       CalibrationNoteKind::told});
}

/// The camera that the last folder or file name of this form names: "image_02", "image_2", "image_02_rect".
std::optional<int> kitti_camera_of(const std::string& path) {
  std::optional<int> camera;
  for (const auto& part : std::filesystem::path(path)) {
    std::string name = detail::in_small_letters(part.string());
    if (!name.starts_with("image_")) continue;
    name.erase(0, 6);
    std::size_t digits = 0;
    while (digits < name.size() && std::isdigit(static_cast<unsigned char>(name[digits]))) ++digits;
    if (digits == 0 || digits > 2 || (digits < name.size() && std::isalpha(static_cast<unsigned char>(name[digits]))))
      continue;
    const int number = std::stoi(name.substr(0, digits));
    if (number <= 3) camera = number;
  }
  return camera;
}

/// @throws InputError for a size that no image has: a number below 0 or too large, or one without the other
void check_size(int width_px, int height_px, const std::string& path, const char* field) {
  constexpr int kMost_px = 1 << 20;  // as of a camera
  if (width_px == 0 && height_px == 0) return;
  if (width_px < 1 || width_px > kMost_px || height_px < 1 || height_px > kMost_px)
    throw InputError(path, field,
                     fmt::format("found {} x {} px, expected 1 to {} px each, or 0 x 0 if it is not known", width_px,
                                 height_px, kMost_px));
}

}  // namespace

void detail::check_said_size(int width_px, int height_px, const CalibrationRequest& request,
                             const std::string& source) {
  const int said_width_px = request.calibrated_width_px, said_height_px = request.calibrated_height_px;
  if (said_width_px == 0 || (width_px == said_width_px && height_px == said_height_px)) return;
  throw InputError(source, "image size",
                   fmt::format("found {} x {} px in the file, but {} x {} px in --calib-size, which is for files that "
                               "give no size or several: leave it out, or correct the file",
                               width_px, height_px, said_width_px, said_height_px));
}

void detail::check_not_padded(int width_px, int height_px, const CalibrationRequest& request,
                              const std::string& source) {
  check_not_padded(request.borders, {request.width_px, request.height_px}, {width_px, height_px}, source);
}

std::optional<detail::ImageScale> detail::scale_to_images(int width_px, int height_px,
                                                          const CalibrationRequest& request) {
  if (const auto one = one_scale(width_px, height_px, request.width_px, request.height_px))
    return ImageScale{*one, *one};
  if (!request.images_are_resized || width_px <= 0 || height_px <= 0 || request.width_px <= 0) return std::nullopt;
  return ImageScale{static_cast<double>(request.width_px) / width_px,
                    static_cast<double>(request.height_px) / height_px};
}

CalibrationNote detail::note_on_scale(int width_px, int height_px, const ImageScale& scale,
                                      const CalibrationRequest& request) {
  const std::string by = scale.across == scale.down
                             ? fmt::format("{:.4g}", scale.across)
                             : fmt::format("{:.4g} horizontally and {:.4g} vertically", scale.across, scale.down);
  auto note = fmt::format("the calibration is for {} x {} px, scaled by {} to the images of {} x {} px", width_px,
                          height_px, by, request.width_px, request.height_px);
  if (request.images_are_resized || scale.across >= 1.0) return {std::move(note), CalibrationNoteKind::told};
  note += fmt::format(
      "; if they were cropped from larger images instead, ranges are {:.3g} times those printed: subtract the columns "
      "and rows cut off at the left and at the top from cx and cy, and give the size of the images",
      1.0 / scale.across);
  return {std::move(note)};
}

std::string detail::note_on_deduced_size(double cx_px, double cy_px, int width_px, int height_px) {
  return fmt::format(
      "the file has no image size; its principal point ({:.1f}, {:.1f}) px fits images of {} x {} px, which is assumed "
      "(--calib-size gives another)",
      cx_px, cy_px, width_px, height_px);
}

bool detail::is_of_other_size(const StereoCamera& camera, const CalibrationRequest& request) {
  return !request.images_are_resized && request.calibrated_width_px == 0 &&
         has_numbers_of(camera, request.width_px, request.height_px);
}

CalibrationNote detail::note_on_wrong_size(const StereoCamera& camera, int width_px, int height_px) {
  return {fmt::format(
      "the file says images of {} x {} px, but its principal point ({:.1f}, {:.1f}) px is in the middle of images of "
      "{} x {} px, as these are: its numbers are taken as those of the images, and not scaled; correct its size, or "
      "give it with --calib-size if it is right",
      camera.width_px, camera.height_px, camera.cx_px, camera.cy_px, width_px, height_px)};
}

std::string detail::note_on_exchanged_size(int width_px, int height_px) {
  return fmt::format(
      "the file's width and height are exchanged, as NumPy and MATLAB write rows first: taken as {} x {} px, which "
      "fits the images and the principal point",
      width_px, height_px);
}

std::vector<std::string> texts(const CalibrationNotes& notes, std::initializer_list<CalibrationNoteKind> kinds) {
  std::vector<std::string> found;
  for (const auto& note : notes)
    if (kinds.size() == 0 || std::ranges::find(kinds, note.kind) != kinds.end()) found.push_back(note.text);
  return found;
}

Calibration detail::completed(Calibration calibration, const CalibrationRequest& request, const std::string& source) {
  settle_baseline(request, source, calibration);
  apply_mount(request, calibration);
  auto& camera = calibration.camera;
  correct_size(request, calibration);
  check_camera(camera, source);
  const bool says_size = camera.width_px > 0;
  const double down_over_across = camera.fy_px / camera.fx_px;
  fit_size(request, source, calibration);
  StereoCamera checked = camera;
  checked.fy_px = down_over_across * checked.fx_px;  // of the calibration: that images were resized was told
  if (calibration.rectifier) {                       // the principal points of raw cameras were looked at as they are
    checked.cx_px = checked.cx_right_px = 0.5 * camera.width_px;
    checked.cy_px = 0.5 * camera.height_px;
  }
  for (auto& note : check_plausible(checked, source, says_size)) calibration.notes.push_back({std::move(note)});
  shift_disparities(request, calibration);
  return calibration;
}

void ask_for_images(CalibrationRequest& request, const RectifiedPair& images) {
  request.width_px = images.left.width_px;
  request.height_px = images.left.height_px;
  request.borders = find_borders(images);
}

Calibration load_calibration(const std::string& path, const CalibrationRequest& request) {
  check_size(request.width_px, request.height_px, path, "image size");
  check_size(request.calibrated_width_px, request.calibrated_height_px, path, "calibrated size");
  if (request.images_are_resized && request.width_px <= 0)
    throw InputError(path, "image size", "of the resized images is not known: give it with --size W,H");
  const auto table = read_number_table(path);
  const auto& format = detail::recognised_format(table);
  if (request.cameras && !format.has_cameras)
    throw InputError(path, "cameras",
                     fmt::format("cannot be chosen: a file of the format {} has only two", format.name));
  if (!request.right_path.empty() && !format.has_second_file)
    throw InputError(
        request.right_path, "right calibration",
        fmt::format("is not used: {} is of the format {}, which holds everything in one file", path, format.name));
  auto calibration = format.read(table, request);
  if (calibration.format.empty()) calibration.format = format.name;
  detail::check_statements(table, request, calibration);
  if (request.images_are_raw && !calibration.rectifier)
    throw InputError(
        path, "raw images",
        fmt::format("cannot be rectified with this file: {} describes rectified images only", format.name));
  return detail::completed(std::move(calibration), request, path);
}

std::string calibration_yaml(const StereoCamera& camera) {
  return fmt::format(
      "# Stereo camera, rectified. Units end the names; pitch is positive when the camera looks down.\n"
      "fx_px: {}\nfy_px: {}\ncx_px: {}\ncx_right_px: {}\ncy_px: {}\nbaseline_m: {}\nwidth_px: {}\nheight_px: {}\n"
      "height_m: {}\npitch_deg: {}\nroll_deg: {}\n",
      camera.fx_px, camera.fy_px, camera.cx_px, camera.cx_right_px, camera.cy_px, camera.baseline_m, camera.width_px,
      camera.height_px, camera.mount.height_m, degrees(camera.mount.pitch_rad), degrees(camera.mount.roll_rad));
}

std::optional<std::array<int, 2>> kitti_cameras_from_paths(const std::string& left, const std::string& right) {
  const auto left_camera = kitti_camera_of(left), right_camera = kitti_camera_of(right);
  if (!left_camera || !right_camera || left_camera == right_camera) return std::nullopt;
  return std::array{*left_camera, *right_camera};
}

}  // namespace flies
