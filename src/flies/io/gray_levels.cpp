#include "flies/io/gray_levels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace flies {
namespace {

/// Bits needed for the brightest pixel of a 16-bit image, at least 8.
int significant_bits(const cv::Mat& gray) {
  double maximum = 0;
  cv::minMaxLoc(gray, nullptr, &maximum);
  return std::max(8, static_cast<int>(std::bit_width(static_cast<unsigned>(maximum))));
}

/// Levels of 16 bits that become black and white; what lies outside is cut off.
struct Band {
  int low = 0, high = 0;
};

/// The levels of images of 16 bits without the darkest and the brightest pixels; nothing of images of 8 bits.
std::optional<Band> band_of(std::initializer_list<const cv::Mat*> images) {
  constexpr double kCutOff = 0.001;  // of the pixels, at both ends
  std::vector<std::size_t> histogram(std::size_t{1} << 16);
  std::size_t pixels = 0;
  for (const cv::Mat* image : images) {
    if (image->depth() != CV_16U) return std::nullopt;
    for (int v = 0; v < image->rows; ++v)
      for (int u = 0; u < image->cols; ++u) ++histogram[image->at<std::uint16_t>(v, u)];
    pixels += image->total();
  }
  const auto cut_off = static_cast<std::size_t>(kCutOff * static_cast<double>(pixels));
  Band band{0, static_cast<int>(histogram.size()) - 1};
  for (std::size_t below = histogram.front(); below <= cut_off;)
    below += histogram[static_cast<std::size_t>(++band.low)];
  for (std::size_t above = histogram.back(); above <= cut_off;)
    above += histogram[static_cast<std::size_t>(--band.high)];
  return band;
}

/// The band that is worth stretching, when shifting would leave next to nothing: a hot pixel far above all others, or a
/// scene in a narrow band of levels, as thermal cameras deliver it.
std::optional<Band> narrow_band(std::initializer_list<const cv::Mat*> images, int bit_depth) {
  constexpr int kEnoughLevels = 40;  // after shifting
  constexpr int kLeastLevels = 16;   // fewer are noise
  const auto band = band_of(images);
  if (!band) return std::nullopt;
  const int levels = band->high - band->low;
  if (levels < kLeastLevels || (levels >> (bit_depth - 8)) >= kEnoughLevels) return std::nullopt;
  return band;
}

/// Whether two bands hardly overlap, as of cameras whose offsets or bits differ, and neither is noise alone.
bool are_apart(const std::optional<Band>& left, const std::optional<Band>& right) {
  constexpr double kMostShared = 0.25;  // of the narrower one
  constexpr int kLeastLevels = 64;
  if (!left || !right) return false;
  const int narrower = std::min(left->high - left->low, right->high - right->low);
  const int shared = std::min(left->high, right->high) - std::max(left->low, right->low);
  return narrower >= kLeastLevels && shared < kMostShared * narrower;
}

/// @param band of a 16-bit image to be stretched; nothing: it is shifted
GrayImage to_8_bits(const cv::Mat& gray, int bit_depth, const std::optional<Band>& band) {
  GrayImage image{gray.cols, gray.rows, std::vector<std::uint8_t>(gray.total())};
  cv::Mat pixels(gray.rows, gray.cols, CV_8U, image.pixels.data());
  if (gray.depth() == CV_8U) {
    gray.copyTo(pixels);
    return image;
  }
  if (band) {
    const int levels = band->high - band->low;
    for (int v = 0; v < gray.rows; ++v)
      std::transform(gray.ptr<std::uint16_t>(v), gray.ptr<std::uint16_t>(v) + gray.cols, pixels.ptr<std::uint8_t>(v),
                     [&](std::uint16_t level) {
                       return static_cast<std::uint8_t>(std::clamp(level - band->low, 0, levels) * 255 / levels);
                     });
    return image;
  }
  // Shifted, not rounded: the brightest level must stay below 256.
  const int shift = bit_depth - 8;
  for (int v = 0; v < gray.rows; ++v)
    std::transform(gray.ptr<std::uint16_t>(v), gray.ptr<std::uint16_t>(v) + gray.cols, pixels.ptr<std::uint8_t>(v),
                   [shift](std::uint16_t level) { return static_cast<std::uint8_t>(level >> shift); });
  return image;
}

}  // namespace

cv::Mat gray_levels(const cv::Mat& image) {
  cv::Mat gray = image;
  if (image.channels() == 2) cv::extractChannel(image, gray, 0);
  if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  if (image.channels() == 4) cv::cvtColor(image, gray, cv::COLOR_BGRA2GRAY);
  return gray;
}

GrayImage image_of_levels(const cv::Mat& levels) {
  const int bit_depth = significant_bits(levels);
  return to_8_bits(levels, bit_depth, narrow_band({&levels}, bit_depth));
}

GrayPair pair_of_levels(const cv::Mat& left, const cv::Mat& right) {
  const int bit_depth = std::max(significant_bits(left), significant_bits(right));
  std::vector<std::string> notes;
  auto left_band = band_of({&left}), right_band = band_of({&right});
  if (are_apart(left_band, right_band))
    notes.push_back(
        fmt::format("the levels of the 16-bit images hardly overlap, left {} to {} and right {} to {}: each is "
                    "stretched by its own",
                    left_band->low, left_band->high, right_band->low, right_band->high));
  else
    left_band = right_band = narrow_band({&left, &right}, bit_depth);
  return {to_8_bits(left, bit_depth, left_band), to_8_bits(right, bit_depth, right_band), bit_depth, std::move(notes)};
}

}  // namespace flies
