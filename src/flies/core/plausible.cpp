#include "flies/core/plausible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <utility>

#include "flies/core/error.hpp"

namespace flies::detail {
namespace {

/// From the narrowest pair of lenses in one housing to the widest bar on a vehicle. Between probable and possible lie
/// endoscopes and aircraft.
constexpr double kLeastBaseline_m = 0.005, kProbableBaseline_m = 0.015;
constexpr double kMostBaseline_m = 10.0, kProbableMostBaseline_m = 3.0;
/// What a wrong unit is guessed towards.
constexpr double kLikelyBaseline_m = 0.03, kLikelyMostBaseline_m = 1.5;

/// Focal length over image width. A rectified image of 157 degrees has most of its pixels at its rim; telescopes see
/// less than 3 degrees.
constexpr double kLeastFocal = 0.1, kProbableFocal = 0.233, kProbableMostFocal = 5.7, kMostFocal = 20.0;

/// A fisheye that shows half a sphere over the whole width has 0.32; picture circles may be far smaller than the
/// sensor.
constexpr double kLeastFisheyeFocal = 0.02;
/// Lenses are shorter than that.
constexpr double kMostOfLens_m = 0.1;
/// Twice a principal point below it is no size in pixels.
constexpr double kLeastSize_px = 2.0;

constexpr double kProbableAspect = 1.1, kMostAspect = 5.0;
/// Distance of the principal point from the middle over the image size. Lenses are centred to a few hundredths.
constexpr double kProbableOffset = 0.07;
/// A file that says its size means images that were cropped when they were rectified, as those of Middlebury and ETH3D.
constexpr double kProbableOffsetOfSized = 0.11;
constexpr double kFarOffset = 0.15;
/// Sizes that a file leaves out show in the principal point: this much off in both directions is another size.
constexpr double kResized = 0.15;

/// Rectified cameras of KITTI, whose files of the object and odometry benchmarks say no size: some sizes share numbers.
struct KittiCamera {
  double f_px, cx_px, cy_px;
  int width_px, height_px;

  bool is(const StereoCamera& camera) const {
    constexpr double kRounding_px = 0.06;  // of files that keep one digit
    return std::abs(camera.fx_px - f_px) < kRounding_px && std::abs(camera.cx_px - cx_px) < kRounding_px &&
           std::abs(camera.cy_px - cy_px) < kRounding_px;
  }
};
constexpr KittiCamera kKittiCameras[] = {
    {721.5377, 609.5593, 172.854, 1242, 375},        {707.0493, 604.0814, 180.5066, 1224, 370},
    {707.0912, 601.8873, 183.1104, 1226, 370},       {707.0912, 601.8873, 183.1104, 1224, 370},
    {718.3351, 600.3891, 181.5122, 1238, 374},       {718.856, 607.1928, 185.2157, 1241, 376},
    {552.554261, 682.049453, 238.769549, 1408, 376},  // KITTI-360
};

/// Whether a camera has the numbers of one of KITTI's.
bool is_kitti(const StereoCamera& camera) {
  return std::ranges::any_of(kKittiCameras, [&](const KittiCamera& kitti) { return kitti.is(camera); });
}

/// Whether a camera is one of KITTI's, of whole images or resized ones: what is odd about its numbers is right.
bool is_of_kitti(const StereoCamera& camera) {
  return std::ranges::any_of(kKittiCameras, [&](const KittiCamera& kitti) {
    const auto scale = one_scale(camera.width_px, camera.height_px, kitti.width_px, kitti.height_px);
    return scale && kitti.is(scaled_camera(camera, {*scale, *scale}, kitti.width_px, kitti.height_px));
  });
}

/// Beyond this the camera does not look along the road and the method's field of detection makes no sense.
constexpr double kMaxTilt_deg = 45.0;
constexpr double kLeastHeight_m = 1e-3, kMostHeight_m = 1e4;

struct Unit {
  const char* name;
  double metres;
};

/// A clause of a question: "is it in millimetres (0.54 m) or feet (1.2 m)"; empty where no guess is likely.
std::string likely(const char* start, const char* last, double baseline, std::initializer_list<Unit> units) {
  std::string clause;
  for (const auto& [name, metres] : units)
    if (const double baseline_m = baseline * metres;
        baseline_m >= kLikelyBaseline_m && baseline_m <= kLikelyMostBaseline_m)
      clause += fmt::format("{}{} ({:.3g} m)", clause.empty() ? start : " or ", name, baseline_m);
  return clause.empty() ? clause : clause + last;
}

std::string likely_units(double baseline, double focal_px) {
  const std::string other = likely("is it in ", " or squares of the board?", baseline,
                                   {{"millimetres", 1e-3},
                                    {"centimetres", 1e-2},
                                    {"inches", 0.0254},
                                    {"feet", 0.3048},
                                    {"decimetres", 0.1},
                                    {"focal length times metres", 1.0 / focal_px}});
  const std::string metres =
      likely("was it written in metres where the file wants ", "?", baseline,
             {{"centimetres", 1e2}, {"millimetres", 1e3}, {"focal length times metres", focal_px}});
  const std::string guess = other + (other.empty() || metres.empty() ? "" : " ") + metres;
  return (guess.empty() ? "is the unit that of the board's squares?" : guess) + " --baseline M gives the right one";
}

void check_baseline(const StereoCamera& camera, const std::string& source, std::vector<std::string>& notes) {
  const double found = camera.baseline_m;
  if (found < kLeastBaseline_m || found > kMostBaseline_m)
    throw InputError(source, "baseline",
                     fmt::format("found {:.4g} m, expected {} to {} m: {}", found, kLeastBaseline_m, kMostBaseline_m,
                                 likely_units(found, camera.fx_px)));
  if (found < kProbableBaseline_m || found > kProbableMostBaseline_m)
    notes.push_back(
        fmt::format("a baseline of {:.4g} m is unlikely for a stereo camera, and all ranges are proportional to it: {}",
                    found, likely_units(found, camera.fx_px)));
}

/// @throws InputError for a principal point that is none in pixels
void check_centre_in_pixels(double cx_px, double cy_px, const std::string& source, const std::string& field) {
  constexpr double kNormalised = 1.0;  // of coordinates that are divided by the size, or counted from the middle
  if (std::abs(cx_px) > kNormalised || std::abs(cy_px) > kNormalised) return;
  throw InputError(source, field,
                   fmt::format("found ({:.4g}, {:.4g}) for cx and cy: are they normalised by the image size, or "
                               "counted from the middle of the image? expected pixels from the top left corner",
                               cx_px, cy_px));
}

double offset(double centre_px, int size_px) { return std::abs(centre_px / size_px - 0.5); }

void check_principal_points(const StereoCamera& camera, const std::string& source, bool says_size,
                            std::vector<std::string>& notes) {
  constexpr int kTiny_px = 8;  // images whose middle lies in the corner
  if (camera.width_px <= 0 || std::max(camera.width_px, camera.height_px) > kTiny_px)
    check_centre_in_pixels(camera.cx_px, camera.cy_px, source, "principal point");
  if (camera.width_px <= 0 || camera.height_px <= 0 || is_of_kitti(camera)) return;
  if (auto note = check_principal_point(camera.cx_px, camera.cy_px, camera.width_px, camera.height_px, source,
                                        "principal point", says_size ? kProbableOffsetOfSized : kProbableOffset))
    notes.push_back(std::move(*note));
  if (std::abs(camera.cx_px - camera.cx_right_px) > kFarOffset * camera.width_px)
    notes.push_back(fmt::format("the principal points of left and right are {:.0f} px apart: check both",
                                std::abs(camera.cx_px - camera.cx_right_px)));
}

}  // namespace

std::vector<std::string> check_focal_length(const StereoCamera& camera, const std::string& source,
                                            const std::string& field, bool sees_to_the_side) {
  std::vector<std::string> notes;
  // A file without a size still has a principal point near the middle.
  const double width_px = camera.width_px > 0 ? camera.width_px : 2.0 * camera.cx_px;
  if (camera.width_px <= 0 && width_px > 0.0 && width_px < kLeastSize_px)
    throw InputError(
        source, field,
        fmt::format("found {:.4g} px, and the principal point at column {:.4g}: are they normalised by the "
                    "image size? expected pixels",
                    camera.fx_px, camera.cx_px));
  if (width_px > 0.0) {
    const double share = camera.fx_px / width_px, angle_deg = degrees(2.0 * std::atan(0.5 / share));
    const auto view = sees_to_the_side ? "" : fmt::format(", a field of view of {:.3g} degrees", angle_deg);
    const auto found = fmt::format("{:.4g} px for images of {:.0f} px across{}", camera.fx_px, width_px, view);
    if (share < (sees_to_the_side ? kLeastFisheyeFocal : kLeastFocal))
      throw InputError(source, field,
                       fmt::format("found {}: is it in {}, or normalised by the image size? expected pixels", found,
                                   camera.fx_px < kMostOfLens_m ? "metres" : "millimetres"));
    if (share > kMostFocal)
      throw InputError(source, field, fmt::format("found {}: is it in micrometres? expected pixels", found));
    if (!sees_to_the_side && (share < kProbableFocal || share > kProbableMostFocal))
      notes.push_back(fmt::format("the focal length is {}: check its unit and the size of the images", found));
  }
  const double aspect = camera.fx_px / camera.fy_px;
  if (aspect > kMostAspect || aspect < 1.0 / kMostAspect)
    throw InputError(
        source, field,
        fmt::format(
            "found {:.4g} px horizontally and {:.4g} px vertically, expected nearly the same: are both in pixels?",
            camera.fx_px, camera.fy_px));
  if (aspect > kProbableAspect || aspect < 1.0 / kProbableAspect)
    notes.push_back(
        fmt::format("the horizontal focal length is {:.3g} times the vertical one ({:.4g} and {:.4g} px), but nearly "
                    "all cameras have square pixels: check whether the images were stretched",
                    aspect, camera.fx_px, camera.fy_px));
  return notes;
}

std::optional<std::string> check_principal_point(double cx_px, double cy_px, int width_px, int height_px,
                                                 const std::string& source, const std::string& field,
                                                 double probable_offset) {
  const double farthest = std::max(offset(cx_px, width_px), offset(cy_px, height_px));
  const auto found = fmt::format("({:.1f}, {:.1f}) px in images of {} x {} px", cx_px, cy_px, width_px, height_px);
  const bool fits_swapped = offset(cy_px, width_px) < kProbableOffset && offset(cx_px, height_px) < kProbableOffset;
  if (fits_swapped && farthest > kFarOffset)
    throw InputError(source, field, fmt::format("found {}: cx and cy, or width and height, are swapped", found));
  if (farthest <= probable_offset) return std::nullopt;
  constexpr double kOfCorner = 0.05;
  if (std::abs(cx_px) <= kOfCorner * width_px && std::abs(cy_px) <= kOfCorner * height_px)
    return fmt::format(
        "the principal point {} lies in the corner of the images: is it counted from the middle of the image? expected "
        "pixels from the top left corner",
        found);
  return fmt::format(
      "the principal point {} is far from the middle: were the images cropped or resized after the calibration?",
      found);
}

std::vector<std::string> check_plausible(const StereoCamera& camera, const std::string& source, bool says_size) {
  std::vector<std::string> notes;
  check_baseline(camera, source, notes);
  for (auto& note : check_focal_length(camera, source, "focal length")) notes.push_back(std::move(note));
  check_principal_points(camera, source, says_size, notes);
  return notes;
}

std::optional<std::array<int, 2>> size_of_unsized(const StereoCamera& camera, int width_px, int height_px) {
  if (is_kitti(camera)) {
    const KittiCamera* best = nullptr;
    for (const auto& kitti : kKittiCameras) {
      if (!kitti.is(camera)) continue;
      if (kitti.width_px == width_px && kitti.height_px == height_px) return std::nullopt;
      if (best == nullptr || one_scale(kitti.width_px, kitti.height_px, width_px, height_px)) best = &kitti;
    }
    return std::array{best->width_px, best->height_px};
  }
  const double across = width_px / (2.0 * camera.cx_px), down = height_px / (2.0 * camera.cy_px);
  for (const int parts : {2, 4})
    if (std::abs(across * parts - 1.0) < kProbableOffset && std::abs(down * parts - 1.0) < 2.0 * kProbableOffset)
      return std::array{parts * width_px, parts * height_px};
  return std::nullopt;
}

void check_size_of_unsized(const StereoCamera& camera, int width_px, int height_px, const std::string& source) {
  if (2.0 * camera.cx_px < kLeastSize_px && 2.0 * camera.cy_px < kLeastSize_px)
    throw InputError(source, "principal point",
                     fmt::format("found ({:.4g}, {:.4g}): are it and the focal length normalised by the image size? "
                                 "expected pixels",
                                 camera.cx_px, camera.cy_px));
  const double across = width_px / (2.0 * camera.cx_px), down = height_px / (2.0 * camera.cy_px);
  const bool is_smaller = across < 1.0 - kResized && down < 1.0 - kResized;
  const bool is_larger = across > 1.0 / (1.0 - kResized) && down > 1.0 / (1.0 - kResized);
  if ((is_smaller || is_larger) && std::abs(across / down - 1.0) < kResized)
    throw InputError(
        source, "image size",
        fmt::format(
            "is not in the file, and its principal point ({:.1f}, {:.1f}) px fits images of about {:.0f} x {:.0f} px, "
            "not of {} x {} px: were the images resized? Give the size that the calibration is for with --calib-size",
            camera.cx_px, camera.cy_px, 2.0 * camera.cx_px, 2.0 * camera.cy_px, width_px, height_px));
}

bool has_exchanged_size(const StereoCamera& camera, int width_px, int height_px) {
  if (camera.width_px != height_px || camera.height_px != width_px || width_px == height_px || width_px <= 0)
    return false;
  const double across = offset(camera.cx_px, width_px), down = offset(camera.cy_px, height_px);
  // A camera that stands on its side has its principal point in the middle of the size that is given.
  const double as_given = std::max(offset(camera.cx_px, height_px), offset(camera.cy_px, width_px));
  return std::max(across, down) <= kFarOffset && std::max(across, down) < as_given;
}

bool has_numbers_of(const StereoCamera& camera, int width_px, int height_px) {
  if (camera.width_px == width_px || !one_scale(camera.width_px, camera.height_px, width_px, height_px)) return false;
  const double across = camera.cx_px / camera.width_px - 0.5, down = camera.cy_px / camera.height_px - 0.5;
  const bool is_far = std::min(std::abs(across), std::abs(down)) > kFarOffset && (across > 0.0) == (down > 0.0);
  return is_far && std::max(offset(camera.cx_px, width_px), offset(camera.cy_px, height_px)) < kProbableOffset;
}

void check_not_exchanged(const StereoCamera& camera, int width_px, int height_px, const std::string& source,
                         const std::string& field) {
  if ((camera.cx_px < width_px && camera.cy_px < height_px) || is_kitti(camera)) return;
  if (std::max(offset(camera.cy_px, width_px), offset(camera.cx_px, height_px)) > kFarOffset) return;
  throw InputError(source, field,
                   fmt::format("found ({:.1f}, {:.1f}) px for images of {} x {} px: cx and cy are swapped, or the "
                               "images are turned by 90 degrees",
                               camera.cx_px, camera.cy_px, width_px, height_px));
}

namespace {

/// Whether one size is the other one divided by a whole number, rounded up or down, as images that were halved are.
bool is_whole_part(int width_px, int height_px, int whole_width_px, int whole_height_px) {
  const int parts = static_cast<int>(std::lround(static_cast<double>(whole_width_px) / width_px));
  const auto fits = [&](std::int64_t part_px, int whole_px) { return std::abs(whole_px - parts * part_px) < parts; };
  return parts > 1 && fits(width_px, whole_width_px) && fits(height_px, whole_height_px);
}

}  // namespace

std::optional<double> one_scale(int from_width_px, int from_height_px, int to_width_px, int to_height_px) {
  if (from_width_px <= 0 || from_height_px <= 0 || to_width_px <= 0 || to_height_px <= 0) return std::nullopt;
  // Some tools round to the nearest size, others down: the scales that lead to it.
  const auto least = [](int from_px, int to_px) { return (to_px - 0.5) / from_px; };
  const auto most = [](int from_px, int to_px) { return (to_px + 1.0) / from_px; };
  const bool is_rounded = std::max(least(from_width_px, to_width_px), least(from_height_px, to_height_px)) <=
                          std::min(most(from_width_px, to_width_px), most(from_height_px, to_height_px));
  // Where the calibration is for halves and the images are whole, it is the calibration's size that was rounded.
  if (!is_rounded && !is_whole_part(from_width_px, from_height_px, to_width_px, to_height_px) &&
      !is_whole_part(to_width_px, to_height_px, from_width_px, from_height_px))
    return std::nullopt;
  return static_cast<double>(to_width_px) / from_width_px;
}

StereoCamera scaled_camera(StereoCamera camera, ImageScale scale, int width_px, int height_px) {
  camera.fx_px *= scale.across;
  camera.fy_px *= scale.down;
  camera.cx_px = scaled_centre_px(camera.cx_px, scale.across);
  camera.cx_right_px = scaled_centre_px(camera.cx_right_px, scale.across);
  camera.cy_px = scaled_centre_px(camera.cy_px, scale.down);
  camera.width_px = width_px;
  camera.height_px = height_px;
  return camera;
}

void check_mount(const CameraMount& mount, const std::string& source) {
  const auto require_within = [&](double value, double least, double most, const char* field, const char* unit) {
    if (!(value >= least && value <= most))
      throw InputError(source, field, fmt::format("found {:.6g}, expected {:g} to {:g}{}", value, least, most, unit));
  };
  require_within(mount.height_m, kLeastHeight_m, kMostHeight_m, "height_m (camera height)", "");
  require_within(degrees(mount.pitch_rad), -kMaxTilt_deg, kMaxTilt_deg, "pitch_deg (camera pitch)", " degrees");
  require_within(degrees(mount.roll_rad), -kMaxTilt_deg, kMaxTilt_deg, "roll_deg (camera roll)", " degrees");
}

void check_camera_matrix(const std::array<double, 9>& m, const std::string& source, const std::string& key) {
  constexpr double kZero = 1e-6;  // relative to the focal length
  const double zero = kZero * std::abs(m[0]);
  if (std::abs(m[2]) <= zero && std::abs(m[5]) <= zero && m[6] > 1.0 && m[7] > 1.0)
    throw InputError(source, key, "is transposed, as MATLAB writes it, expected fx 0 cx, 0 fy cy, 0 0 1");
  if (!(m[0] > 0.0) || !(m[4] > 0.0))
    throw InputError(source, key,
                     fmt::format("found focal lengths {:.6g} and {:.6g}, expected positive ones", m[0], m[4]));
  check_centre_in_pixels(m[2], m[5], source, key);
  if (std::abs(m[3]) > zero || std::abs(m[6]) > kZero || std::abs(m[7]) > kZero || std::abs(m[8] - 1.0) > kZero)
    throw InputError(source, key, "is not a camera matrix, expected fx 0 cx, 0 fy cy, 0 0 1");
}

void check_rotation(const std::array<double, 9>& r, const std::string& source, const std::string& key) {
  constexpr double kRounding = 1e-3;  // of files that keep four digits
  const auto dot = [&](std::size_t a, std::size_t b) {
    return r[3 * a] * r[3 * b] + r[3 * a + 1] * r[3 * b + 1] + r[3 * a + 2] * r[3 * b + 2];
  };
  double fault = 0.0;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) fault = std::max(fault, std::abs(dot(a, b) - (a == b ? 1.0 : 0.0)));
  const double determinant =
      r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) + r[2] * (r[3] * r[7] - r[4] * r[6]);
  if (fault > kRounding || determinant < 0.0)
    throw InputError(
        source, key,
        fmt::format("is not a rotation matrix (its rows are {:.3g} off from orthonormal, determinant {:.3g})", fault,
                    determinant));
}

}  // namespace flies::detail
