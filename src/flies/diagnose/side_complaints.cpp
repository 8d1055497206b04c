#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "flies/diagnose/compare_sides.hpp"

namespace flies {
namespace {

constexpr double kBlindShare = 0.1;
constexpr double kBlurred = 0.6;
/// Of brightness or contrast: 0.85 and more in good pairs. Less is another exposure or gain.
constexpr double kDimmed = 0.75;
constexpr double kBlindPatch = 0.007, kLostRows = 0.005;
constexpr double kBlurredPart = 0.3;

double lesser_ratio(double ratio) { return std::min(ratio, 1.0 / std::max(ratio, 1e-6)); }

std::vector<std::string> blind_sides(const SideDifference& d) {
  const auto tell = [](double share, const char* blind, const char* other) {
    return fmt::format(
        "the {} image shows nothing in {:.0f} % of what the {} one sees: is that camera covered or far too dark, or a "
        "part of its image missing?",
        blind, 100.0 * share, other);
  };
  std::vector<std::string> found;
  if (d.right_blind_share > kBlindShare) found.push_back(tell(d.right_blind_share, "right", "left"));
  if (d.left_blind_share > kBlindShare) found.push_back(tell(d.left_blind_share, "left", "right"));
  return found;
}

/// A patch that is calm all the more where all of the image is blurred or faint.
double patch_of_its_own(double patch, double sharpness, double brightness) {
  constexpr double kByBlur = 0.03, kByExposure = 0.015;
  const bool follows = (sharpness < kBlurred && patch < kByBlur) || (brightness < kDimmed && patch < kByExposure);
  return follows ? 0.0 : patch;
}

std::vector<std::string> blind_parts(const SideDifference& d) {
  std::vector<std::string> found;
  const double right_patch = patch_of_its_own(d.right_blind_patch, d.sharpness, d.brightness);
  const double left_patch =
      patch_of_its_own(d.left_blind_patch, 1.0 / std::max(d.sharpness, 1e-6), 1.0 / std::max(d.brightness, 1e-6));
  for (const auto& [image, other, rows, columns, patch] :
       {std::tuple("right", "left", d.right_lost_rows, d.right_lost_columns, right_patch),
        std::tuple("left", "right", d.left_lost_rows, d.left_lost_columns, left_patch)})
    if (columns > kLostRows)
      found.push_back(
          fmt::format("{:.0f} % of the columns of the {} image have one grey level throughout: are these stuck in the "
                      "sensor of that camera?",
                      std::max(1.0, 100.0 * columns), image));
    else if (rows > kLostRows)
      found.push_back(
          fmt::format("{:.0f} % of the rows of the {} image have one grey level throughout: were lines lost "
                      "on the way from that camera?",
                      std::max(1.0, 100.0 * rows), image));
    else if (patch > kBlindPatch)
      found.push_back(
          fmt::format("a patch of {:.0f} % of the {} image shows nothing where the {} one sees something: "
                      "is there dirt on that lens, or a part of its image missing?",
                      std::max(1.0, 100.0 * patch), image, other));
  return found;
}

bool is_as_bright(const SideDifference& d) { return lesser_ratio(d.brightness) >= kDimmed; }

bool is_fainter_on_one_side(const SideDifference& d) {
  return std::max(d.contrast, d.brightness) < kDimmed || std::min(d.contrast, d.brightness) > 1.0 / kDimmed;
}

/// An image that is too bright has little contrast where it is not white, which is no noise.
bool tells_noise(const SideDifference& d) {
  const bool is_brighter = d.right_noise.is_much() ? d.brightness > 1.0 : d.brightness < 1.0;
  return d.is_noisy_on_one_side() && !(d.is_exposed_unlike() && is_brighter);
}

std::string noisy_side(const SideDifference& d) {
  const bool is_right = d.right_noise.is_much();
  const auto& [noisy, other] =
      is_right ? std::pair(d.right_noise, d.left_noise) : std::pair(d.left_noise, d.right_noise);
  return fmt::format(
      "the {} image is noisy: its pixels vary by {:.1f} grey levels at random and by {:.1f} with the scene, those of "
      "the {} one by {:.1f} at random, so things are missed: is the gain of that camera higher, its exposure shorter, "
      "or its cable or sensor faulty?",
      is_right ? "right" : "left", noisy.noise_gray, noisy.contrast_gray, is_right ? "left" : "right",
      other.noise_gray);
}

/// Of an image that is the noisy one, sharpness says nothing.
std::optional<std::string> blurred_side(const SideDifference& d) {
  const auto is_noisy = [&](bool is_right) {
    return d.is_noisy_on_one_side() && (is_right ? d.right_noise : d.left_noise).is_much();
  };
  const double blurred = lesser_ratio(d.sharpness);
  if (blurred < kBlurred && !is_noisy(d.sharpness < 1.0))
    return fmt::format(
        "the {} image is {:.2g} times as sharp as the other: is that camera out of focus, or its lens dirty?",
        d.sharpness < 1.0 ? "right" : "left", blurred);
  const double blurred_part = std::min(d.least_sharpness, 1.0 / std::max(d.most_sharpness, 1e-6));
  const bool is_right = d.least_sharpness <= blurred_part;
  if (blurred_part < kBlurredPart && !is_noisy(is_right))
    return fmt::format(
        "a part of the {} image is {:.2g} times as sharp as in the other: is there a drop or dirt on that lens?",
        is_right ? "right" : "left", blurred_part);
  return std::nullopt;
}

}  // namespace

bool SideDifference::is_exposed_unlike() const { return lesser_ratio(contrast) < kDimmed || !is_as_bright(*this); }

bool SideDifference::is_noisy_on_one_side() const { return left_noise.is_much() != right_noise.is_much(); }

const ImageNoise& SideDifference::noise() const {
  return left_noise.contrast_to_noise() < right_noise.contrast_to_noise() ? left_noise : right_noise;
}

std::vector<std::string> complaints(const SideDifference& d) {
  auto found = blind_sides(d);
  if (!found.empty()) return found;  // which contrast and sharpness follow from
  found = blind_parts(d);
  const bool shows_all = found.empty();
  auto blurred = blurred_side(d);
  const bool is_by_blur = blurred && is_as_bright(d);  // which costs contrast
  // A part that shows nothing changes either brightness or contrast, or both the other way round.
  if (shows_all ? d.is_exposed_unlike() && !is_by_blur : is_fainter_on_one_side(d))
    found.push_back(
        fmt::format("the right image is {:.2g} times as bright as the left one and has {:.2g} times its contrast: are "
                    "exposure and gain of both cameras the same?",
                    d.brightness, d.contrast));
  const bool is_comparable = found.empty();
  if (tells_noise(d)) found.push_back(noisy_side(d));
  if (blurred && is_comparable) found.push_back(*std::move(blurred));
  return found;
}

}  // namespace flies
