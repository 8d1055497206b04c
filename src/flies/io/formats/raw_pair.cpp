#include "flies/io/formats/raw_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/plausible.hpp"

namespace flies::detail {
namespace {

struct NamedLens {
  const char* name;
  Lens lens;
};

/// As ROS, Kalibr, EuRoC, ORB-SLAM, Basalt and OpenCV's users write them.
constexpr NamedLens kLenses[] = {{"", Lens::brown},
                                 {"none", Lens::brown},
                                 {"pinhole", Lens::brown},
                                 {"perspective", Lens::brown},
                                 {"plumb_bob", Lens::brown},
                                 {"radtan", Lens::brown},
                                 {"radial-tangential", Lens::brown},
                                 {"radialtangential", Lens::brown},
                                 {"radialtangential8", Lens::brown},
                                 {"rational_polynomial", Lens::brown},
                                 {"thin_prism", Lens::brown},
                                 {"brown", Lens::brown},
                                 {"brown_conrady", Lens::brown},
                                 {"pinhole-radtan8", Lens::brown},
                                 {"equidistant", Lens::equidistant},
                                 {"equi", Lens::equidistant},
                                 {"fisheye", Lens::equidistant},
                                 {"kb4", Lens::equidistant},
                                 {"kannala_brandt", Lens::equidistant},
                                 {"kannala-brandt", Lens::equidistant},
                                 {"kannalabrandt", Lens::equidistant},
                                 {"kannalabrandt4", Lens::equidistant},
                                 {"kannalabrandt8", Lens::equidistant},
                                 {"ds", Lens::double_sphere},
                                 {"double_sphere", Lens::double_sphere},
                                 {"eucm", Lens::unified},
                                 {"ucm", Lens::unified},
                                 {"omni", Lens::mei},
                                 {"mei", Lens::mei},
                                 {"fov", Lens::fov}};

std::vector<std::size_t> allowed_counts(Lens lens) {
  switch (lens) {
    case Lens::equidistant:
      return {4};
    case Lens::double_sphere:
    case Lens::unified:
      return {2};
    case Lens::mei:
      return {1, 5};
    case Lens::fov:
      return {1};
    case Lens::brown:
      break;
  }
  return {4, 5, 8, 12, 14};
}

void check_distortion(const RawCamera& camera, const std::string& key, const std::string& source) {
  const auto counts = allowed_counts(camera.lens);
  if (std::find(counts.begin(), counts.end(), camera.distortion.size()) != counts.end()) return;
  throw InputError(source, key,
                   fmt::format("found {} coefficients of distortion, expected {} for the {} model",
                               camera.distortion.size(), fmt::join(counts, " or "), lens_name(camera.lens)));
}

/// What a camera says that a lens of the radial and tangential model hardly can: a file that does not name the model of
/// a fisheye's four coefficients, or another order of the coefficients. Empty when there is nothing to say.
std::string note_on_lens(const RawCamera& camera, const std::string& key, int width_px, int height_px) {
  if (camera.lens != Lens::brown) return {};
  // Beyond it, 58 degrees from the axis were the lens without distortion, pinholes with lenses end; and tangential
  // coefficients are the few thousandths by which a lens stands askew.
  constexpr double kWidestPinhole = 1.6, kMostTangential = 0.02;
  const auto& m = camera.matrix;
  const double corner = std::hypot(0.5 * width_px / m[0], 0.5 * height_px / m[4]);
  const auto& d = camera.distortion;
  const bool is_bent = std::ranges::any_of(d, [](double coefficient) { return coefficient != 0.0; });
  std::string odd;
  if (is_bent && corner > kWidestPinhole)
    odd = fmt::format("a view of {:.0f} degrees from corner to corner",
                      2.0 * std::atan(corner) * 180.0 / std::numbers::pi);
  for (const std::size_t tangential : {2U, 3U})
    if (odd.empty() && d.size() > tangential && std::abs(d[tangential]) > kMostTangential)
      odd = fmt::format("a tangential coefficient p{} of {:.3g}", tangential - 1, d[tangential]);
  if (odd.empty()) return {};
  return fmt::format(
      "{}: {} is improbable for the {} model: is it a fisheye lens (distortion_model: equidistant), or are the "
      "coefficients in another order than k1 k2 p1 p2 k3?",
      key, odd, lens_name(camera.lens));
}

/// The camera matrix of images that were resized.
void scale(RawCamera& camera, ImageScale by) {
  auto& m = camera.matrix;
  m[0] *= by.across;
  m[1] *= by.across;
  m[4] *= by.down;
  m[2] = scaled_centre_px(m[2], by.across);
  m[5] = scaled_centre_px(m[5], by.down);
}

void check(const RawPair& pair, const std::string& source) {
  const RawCamera &left = pair.stereo.left, &right = pair.stereo.right;
  check_camera_matrix(left.matrix, source, pair.left_key);
  check_camera_matrix(right.matrix, source, pair.right_key);
  check_rotation(pair.stereo.rotation, source, pair.pose_key);
  if (std::ranges::all_of(pair.stereo.translation_m, [](double t) { return t == 0.0; }))
    throw InputError(source, "baseline",
                     fmt::format("found 0 m: both cameras stand in one place ({}, {})", pair.left_key, pair.right_key));
  check_distortion(left, pair.left_key, source);
  check_distortion(right, pair.right_key, source);
  if (left.lens != right.lens)
    throw InputError(source, pair.right_key,
                     fmt::format("found a lens of the {} model, and {} has the {} one, expected the same",
                                 lens_name(right.lens), pair.left_key, lens_name(left.lens)));
  if (pair.stereo.width_px == 0 || pair.stereo.height_px == 0)
    throw InputError(source, "image_width, image_height", "are missing, and rectifying needs the size of the images");
}

}  // namespace

Calibration calibration_from_raw(RawPair pair, const CalibrationRequest& request, const std::string& source) {
  auto& raw = pair.stereo;
  for (RawCamera* camera : {&raw.left, &raw.right})
    if (camera->lens == Lens::brown && camera->distortion.empty()) camera->distortion.assign(5, 0.0);
  check(pair, source);
  Calibration calibration;
  calibration.notes = std::move(pair.notes);
  if (auto note = check_turn(raw.rotation, source, pair.pose_key); !note.empty())
    calibration.notes.push_back(std::move(note));
  for (const auto& [camera, key] : {std::pair{&raw.left, &pair.left_key}, std::pair{&raw.right, &pair.right_key}})
    if (auto note = note_on_lens(*camera, *key, raw.width_px, raw.height_px); !note.empty()) {
      calibration.notes.push_back(std::move(note));
      break;  // both have the same lens
    }
  for (const auto& [camera, key] : {std::pair{&raw.left, &pair.left_key}, std::pair{&raw.right, &pair.right_key}})
    if (const auto note =
            check_principal_point(camera->matrix[2], camera->matrix[5], raw.width_px, raw.height_px, source, *key))
      calibration.notes.push_back(*key + ": " + *note);
  const auto by = scale_to_images(raw.width_px, raw.height_px, request);
  if (by && (raw.width_px != request.width_px || raw.height_px != request.height_px)) {
    calibration.notes.push_back(note_on_scale(raw.width_px, raw.height_px, *by, request));
    scale(raw.left, *by);
    scale(raw.right, *by);
    raw.width_px = request.width_px;
    raw.height_px = request.height_px;
  }
  calibration.rectifier.emplace(raw, source);
  calibration.camera = calibration.rectifier->camera();
  calibration.left_name = pair.left_key;
  calibration.right_name = pair.right_key;
  const double share = calibration.camera.fx_px / calibration.camera.width_px;
  constexpr double kRounding = 1.01;
  if (share < kRounding * kWidestRectified)
    calibration.notes.push_back(
        fmt::format("the lenses see farther to the side than a rectified image can show, of which {:.0f} degrees stay",
                    2.0 * std::atan(0.5 / share) * 180.0 / std::numbers::pi));
  calibration.notes.push_back(
      fmt::format("the images are taken as raw and rectified first, with the {} model", lens_name(raw.left.lens)));
  return calibration;
}

void set_pose(RawStereo& stereo, const Pose& right_from_left) {
  stereo.rotation = right_from_left.rotation;
  stereo.translation_m = right_from_left.translation;
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
  for (const char* name : names) {
    padding.push_back(table.has(prefix + name) ? table.require_number(prefix + name) : 0.0);
    if (table.has(prefix + name)) values = padding;
  }
  if (values.size() < least) values.resize(least, 0.0);
  return values;
}

Lens lens_of(const std::string& word, const std::string& key, const std::string& source) {
  const auto* found =
      std::find_if(std::begin(kLenses), std::end(kLenses), [&](const NamedLens& lens) { return word == lens.name; });
  if (found != std::end(kLenses)) return found->lens;
  throw InputError(source, key,
                   fmt::format("found '{}', expected plumb_bob, radtan, rational_polynomial, equidistant, fisheye, ds, "
                               "eucm, omni or fov",
                               word));
}

ImageSize size_of_list(const NumberTable& table, const std::string& key) {
  const auto& size = table.require(key, 2);
  const auto pixels = [&](double number) {
    NumberTable one{table.source, {}};
    one.entries[key].numbers = {number};
    return one.require_size(key);
  };
  return {pixels(size[0]), pixels(size[1])};
}

std::size_t size_of_images(const std::vector<ImageSize>& sizes, const CalibrationRequest& request,
                           const std::string& source) {
  std::optional<std::size_t> like;
  std::string known;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const auto [width_px, height_px] = sizes[i];
    const bool is_said = request.images_are_resized && width_px == request.calibrated_width_px &&
                         height_px == request.calibrated_height_px;
    if (request.width_px == 0 || is_said || (width_px == request.width_px && height_px == request.height_px)) return i;
    if (!like && one_scale(width_px, height_px, request.width_px, request.height_px)) like = i;
    known += fmt::format("{}{} x {}", known.empty() ? "" : ", ", width_px, height_px);
  }
  if (like) return *like;
  throw InputError(source, "image size",
                   fmt::format("{} x {} px is none of the modes of this file: {}; of images that were resized by other "
                               "scales across and down, say which: --resized --calib-size W,H",
                               request.width_px, request.height_px, known.empty() ? "none known" : known));
}

void check_same_size(ImageSize left, ImageSize right, const std::string& source, const std::string& key) {
  if (left.width_px == right.width_px && left.height_px == right.height_px) return;
  throw InputError(source, key,
                   fmt::format("found {} x {} px, expected {} x {} px as for the left camera", right.width_px,
                               right.height_px, left.width_px, left.height_px));
}

ImageSize known_size(ImageSize of_file, const CalibrationRequest& request, const std::string& source) {
  if (of_file.width_px > 0) return of_file;
  if (request.calibrated_width_px > 0) return {request.calibrated_width_px, request.calibrated_height_px};
  if (request.images_are_resized)
    throw InputError(source, "image size", "is not in the file: say what the images were resized from (--calib-size)");
  return {request.width_px, request.height_px};
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
