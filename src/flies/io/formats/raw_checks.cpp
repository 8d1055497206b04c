#include "flies/io/formats/raw_checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/plausible.hpp"

namespace flies::detail {
namespace {

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

/// Where a ray at this distance from the axis, both in focal lengths, is seen by the radial part of the model.
double bent(const std::vector<double>& d, double r) {
  const double q = r * r, k3 = d.size() > 4 ? d[4] : 0.0;
  return r * (1.0 + q * (d[0] + q * (d[1] + q * k3)));
}

/// The distance from the axis, in focal lengths, that no ray is seen beyond; nothing when some reach `needed`.
std::optional<double> fold(const std::vector<double>& d, double needed) {
  constexpr double kStep = 0.002, kFarthest = 5.0;  // nearly at right angles to the axis
  double before = 0.0;
  for (double r = kStep; r < kFarthest && before < needed; r += kStep) {
    const double now = bent(d, r);
    if (now < before) return before;
    before = now;
  }
  return std::nullopt;
}

}  // namespace

void check_raw_pair(const RawPair& pair, const std::string& source) {
  const RawCamera &left = pair.stereo.left, &right = pair.stereo.right;
  check_camera_matrix(left.matrix, source, pair.left_key);
  check_camera_matrix(right.matrix, source, pair.right_key);
  check_rotation(pair.stereo.rotation, source, pair.pose_key);
  if (std::ranges::all_of(pair.stereo.translation_m, [](double t) { return t == 0.0; }))
    throw InputError(
        source, "baseline",
        fmt::format("found 0 m: both cameras are in the same place ({}, {})", pair.left_key, pair.right_key));
  check_distortion(left, pair.left_distortion(), source);
  check_distortion(right, pair.right_distortion(), source);
  if (left.lens != right.lens)
    throw InputError(source, pair.right_key,
                     fmt::format("found a lens of the {} model, and {} has the {} one, expected the same",
                                 lens_name(right.lens), pair.left_key, lens_name(left.lens)));
}

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

std::string note_on_fold(const RawCamera& camera, const std::string& key, int width_px, int height_px) {
  // Quotients of the rational model may have poles, thin rings that are told elsewhere.
  constexpr std::size_t kPolynomial = 5;
  if (camera.lens != Lens::brown || camera.distortion.size() > kPolynomial) return {};
  // Good calibrations may fold in the outermost corners, where no board was seen.
  constexpr double kWithin = 0.8;
  const auto& m = camera.matrix;
  const double corner = std::hypot(0.5 * width_px / m[0], 0.5 * height_px / m[4]);
  const auto at = fold(camera.distortion, kWithin * corner);
  if (!at) return {};
  return fmt::format(
      "{}: with its distortion coefficients nothing is seen more than {:.0f} px from the principal point, but images "
      "of {} x {} px reach {:.0f} px: no lens bends rays back like that; are the coefficients in another order than k1 "
      "k2 p1 p2 k3, of another model, or from a calibration with too few views?",
      key, *at * m[0], width_px, height_px, corner * m[0]);
}

std::string note_on_skew(const RawCamera& camera, const std::string& key) {
  constexpr double kLeast = 1e-5;  // of the focal length: a hundredth of a pixel at the border of the image
  const double skew = camera.matrix[1];
  if (std::abs(skew) <= kLeast * camera.matrix[0]) return {};
  if (camera.lens != Lens::brown && camera.lens != Lens::equidistant) return {};  // whose equations here have it
  return fmt::format(
      "{}: its skew of {:.4g} px is ignored, as OpenCV's models have none: calibrate without skew (MATLAB: "
      "EstimateSkew false)",
      key, skew);
}

}  // namespace flies::detail
