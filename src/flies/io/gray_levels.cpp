#include "flies/io/gray_levels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/io/images.hpp"
#include "flies/io/packed_yuv.hpp"

namespace flies {
namespace {

/// Bits needed for the brightest pixel of a 16-bit image, at least 8.
int significant_bits(const cv::Mat& gray) {
  double maximum = 0;
  cv::minMaxLoc(gray, nullptr, &maximum);
  return std::max(8, static_cast<int>(std::bit_width(static_cast<unsigned>(maximum))));
}

/// Levels that become black and white; what lies outside is cut off.
struct Band {
  int low = 0, high = 0;
};

using Images = std::initializer_list<const cv::Mat*>;

/// Every fourth row of bytes tells enough, and nearly all pairs are of bytes.
int row_step(const cv::Mat& image) { return image.depth() == CV_8U ? 4 : 1; }

template <class Level>
void count_levels(const cv::Mat& image, std::vector<std::size_t>& histogram) {
  for (int v = 0; v < image.rows; v += row_step(image))
    for (int u = 0; u < image.cols; ++u) ++histogram[image.at<Level>(v, u)];
}

std::vector<std::size_t> histogram_of(Images images, bool is_of_bytes) {
  std::vector<std::size_t> histogram(std::size_t{1} << (is_of_bytes ? 8 : 16));
  for (const cv::Mat* image : images)
    is_of_bytes ? count_levels<std::uint8_t>(*image, histogram) : count_levels<std::uint16_t>(*image, histogram);
  return histogram;
}

/// The levels of images of one depth without the darkest and the brightest pixels. A black border and a burnt sky of
/// bytes do not count.
Band band_of(Images images) {
  constexpr double kCutOff = 0.001;  // of the pixels, at both ends
  const bool is_of_bytes = (*images.begin())->depth() == CV_8U;
  auto histogram = histogram_of(images, is_of_bytes);
  const auto cut_off_of = [&] {
    const std::size_t pixels = std::accumulate(histogram.begin(), histogram.end(), std::size_t{0});
    return static_cast<std::size_t>(kCutOff * static_cast<double>(pixels));
  };
  if (is_of_bytes)
    for (auto* end : {&histogram.front(), &histogram.back()})
      if (*end > cut_off_of()) *end = 0;
  if (std::ranges::all_of(histogram, [](std::size_t count) { return count == 0; })) return {};
  const std::size_t cut_off = cut_off_of();
  Band band{0, static_cast<int>(histogram.size()) - 1};
  for (std::size_t below = histogram.front(); below <= cut_off;)
    below += histogram[static_cast<std::size_t>(++band.low)];
  for (std::size_t above = histogram.back(); above <= cut_off;)
    above += histogram[static_cast<std::size_t>(--band.high)];
  return band;
}

/// Ends that are the same for like pairs, so that an image that comes twice stays the same.
Band rounded_outwards(const Band& band) {
  constexpr int kStep = 8, kLast = 255;
  return {band.low / kStep * kStep, std::min(kLast, (band.high + kStep - 1) / kStep * kStep)};
}

/// Mean square of the steps from column to column, over the variance: 2 for noise, 0.11 and less in good images.
double roughness(const cv::Mat& image) {
  double sum = 0.0, squares = 0.0, steps = 0.0;
  std::size_t pixels = 0;
  cv::Mat row;
  for (int v = 0; v < image.rows; v += row_step(image)) {
    image.row(v).convertTo(row, CV_64F);
    const double* level = row.ptr<double>();
    for (int u = 0; u < image.cols; ++u) {
      const double step = u > 0 ? level[u] - level[u - 1] : 0.0;
      sum += level[u];
      squares += level[u] * level[u];
      steps += step * step;
    }
    pixels += static_cast<std::size_t>(image.cols);
  }
  const double variance = squares - sum * sum / static_cast<double>(pixels);
  return variance > 0.0 ? steps / variance : 0.0;
}

cv::Mat exchanged_bytes(const cv::Mat& image) {
  cv::Mat exchanged(image.size(), image.type());
  const auto levels = static_cast<std::ptrdiff_t>(image.cols) * image.channels();
  for (int v = 0; v < image.rows; ++v)
    std::transform(image.ptr<std::uint16_t>(v), image.ptr<std::uint16_t>(v) + levels, exchanged.ptr<std::uint16_t>(v),
                   [](std::uint16_t level) { return static_cast<std::uint16_t>(level << 8 | level >> 8); });
  return exchanged;
}

/// Whether the bytes of 16-bit levels stand in the other order: from column to column these levels change as noise
/// does, and with the bytes exchanged as images do.
bool has_exchanged_bytes(const cv::Mat& image) {
  constexpr double kRough = 0.5, kMuchSmoother = 0.4;
  if (image.depth() != CV_16U) return false;
  const double as_given = roughness(image);
  return as_given > kRough && roughness(exchanged_bytes(image)) < kMuchSmoother * as_given;
}

std::string note_on_bytes(const std::string& whose) {
  return fmt::format(
      "the bytes of the 16-bit levels{} are in the wrong order for the format (PGM: the upper byte first); they are "
      "swapped",
      whose);
}

/// The band that is worth stretching, when too little contrast would be left of 256 levels: a hot pixel far above all
/// others, or a scene in a narrow band of levels, as in fog or of thermal cameras. Good pairs have 211 levels and more.
/// Of 72 obstacles in six pairs of kitti_stereo2012, 66, 41 and 32 are left with 0.75, 0.3 and 0.15 of their contrast,
/// and 62 with 0.15 of it stretched. What is mostly noise, as of dark or covered cameras, would become texture.
std::optional<Band> narrow_band(Images images, int bit_depth) {
  constexpr int kEnoughLevels = 160, kHardlyAny = 40;  // after shifting
  constexpr int kLeastLevels = 16;                     // fewer are noise
  constexpr double kRough = 0.3;
  const Band band = band_of(images);
  const int levels = band.high - band.low, remaining = levels >> (bit_depth - 8);
  if (levels < kLeastLevels || remaining >= kEnoughLevels) return std::nullopt;
  const bool is_lost_otherwise = remaining < kHardlyAny && bit_depth > 8;
  const auto is_noise = [](const cv::Mat* image) { return roughness(*image) > kRough; };
  if (!is_lost_otherwise && std::ranges::any_of(images, is_noise)) return std::nullopt;
  return (*images.begin())->depth() == CV_8U ? rounded_outwards(band) : band;
}

/// Whether two bands hardly overlap, as of cameras whose offsets or bits differ, and neither is noise alone.
bool are_apart(const Band& left, const Band& right) {
  constexpr double kMostShared = 0.25;  // of the narrower one
  constexpr int kLeastLevels = 64;
  const int narrower = std::min(left.high - left.low, right.high - right.low);
  const int shared = std::min(left.high, right.high) - std::max(left.low, right.low);
  return narrower >= kLeastLevels && shared < kMostShared * narrower;
}

template <class Level>
void stretch(const cv::Mat& gray, const Band& band, cv::Mat& pixels) {
  const int levels = band.high - band.low;
  for (int v = 0; v < gray.rows; ++v)
    std::transform(gray.ptr<Level>(v), gray.ptr<Level>(v) + gray.cols, pixels.ptr<std::uint8_t>(v), [&](Level level) {
      return static_cast<std::uint8_t>(std::clamp(level - band.low, 0, levels) * 255 / levels);
    });
}

/// @param band of levels to be stretched; nothing: those of 16 bits are shifted
GrayImage to_8_bits(const cv::Mat& gray, int bit_depth, const std::optional<Band>& band) {
  GrayImage image{gray.cols, gray.rows, std::vector<std::uint8_t>(gray.total())};
  cv::Mat pixels(gray.rows, gray.cols, CV_8U, image.pixels.data());
  const bool is_of_bytes = gray.depth() == CV_8U;
  if (band) {
    is_of_bytes ? stretch<std::uint8_t>(gray, *band, pixels) : stretch<std::uint16_t>(gray, *band, pixels);
    return image;
  }
  if (is_of_bytes) {
    gray.copyTo(pixels);
    return image;
  }
  // Shifted, not rounded: the brightest level must stay below 256.
  const int shift = bit_depth - 8;
  for (int v = 0; v < gray.rows; ++v)
    std::transform(gray.ptr<std::uint16_t>(v), gray.ptr<std::uint16_t>(v) + gray.cols, pixels.ptr<std::uint8_t>(v),
                   [shift](std::uint16_t level) { return static_cast<std::uint8_t>(level >> shift); });
  return image;
}

/// Nothing where the images have contrast enough not to wonder.
std::optional<std::string> faint_note(const Band& band) {
  constexpr int kFaintLevels = 96;
  const int levels = band.high - band.low;
  if (levels >= kFaintLevels) return std::nullopt;
  return "the levels of both images lie in a narrow band, as in fog or behind a dirty window; they are stretched alike";
}

}  // namespace

std::optional<std::string> put_bytes_in_order(cv::Mat& image) {
  constexpr int kGreen = 1;
  if (image.depth() != CV_16U || image.channels() < 3) return std::nullopt;
  cv::Mat green;
  cv::extractChannel(image, green, kGreen);
  if (!has_exchanged_bytes(green)) return std::nullopt;
  image = exchanged_bytes(image);
  return note_on_bytes("");
}

cv::Mat gray_levels(const cv::Mat& image) {
  cv::Mat gray = image;
  if (image.channels() == 2) cv::extractChannel(image, gray, 0);
  if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  if (image.channels() == 4) cv::cvtColor(image, gray, cv::COLOR_BGRA2GRAY);
  return gray;
}

GrayImage image_of_levels(const cv::Mat& given) {
  const cv::Mat levels = has_exchanged_bytes(given) ? exchanged_bytes(given) : given;
  const int bit_depth = significant_bits(levels);
  const bool is_of_bytes = levels.depth() == CV_8U;
  return to_8_bits(levels, bit_depth, is_of_bytes ? std::nullopt : narrow_band({&levels}, bit_depth));
}

GrayPair pair_of_levels(const cv::Mat& left, const cv::Mat& right) {
  const bool is_left_exchanged = has_exchanged_bytes(left), is_right_exchanged = has_exchanged_bytes(right);
  if (is_left_exchanged || is_right_exchanged) {
    GrayPair pair = pair_of_levels(is_left_exchanged ? exchanged_bytes(left) : left,
                                   is_right_exchanged ? exchanged_bytes(right) : right);
    pair.notes.push_back(note_on_bytes(is_left_exchanged && is_right_exchanged ? ""
                                       : is_left_exchanged                     ? " of the left image"
                                                                               : " of the right image"));
    return pair;
  }
  if (const auto layout = detail::recognise_yuv(left); layout && layout == detail::recognise_yuv(right)) {
    GrayPair pair = pair_of_levels(detail::luma_of(left, *layout), detail::luma_of(right, *layout));
    pair.notes.push_back(detail::note_on_yuv(*layout, pair.left.width_px, pair.left.height_px));
    return pair;
  }
  const int bit_depth = std::max(significant_bits(left), significant_bits(right));
  const bool is_of_bytes = left.depth() == CV_8U;
  std::vector<std::string> notes;
  std::optional<Band> left_band, right_band;
  if (!is_of_bytes) {
    left_band = band_of({&left});
    right_band = band_of({&right});
  }
  if (!is_of_bytes && are_apart(*left_band, *right_band)) {
    notes.push_back(
        fmt::format("the levels of the 16-bit images hardly overlap, left {} to {} and right {} to {}: each is "
                    "stretched by its own",
                    left_band->low, left_band->high, right_band->low, right_band->high));
  } else {
    left_band = right_band = narrow_band({&left, &right}, bit_depth);
    if (is_of_bytes && left_band)
      if (auto note = faint_note(*left_band)) notes.push_back(*std::move(note));
  }
  return {to_8_bits(left, bit_depth, left_band), to_8_bits(right, bit_depth, right_band), bit_depth, std::move(notes)};
}

void stretch_faint(GrayPair& images) {
  const auto levels_of = [](GrayImage& image) {
    return cv::Mat(image.height_px, image.width_px, CV_8U, image.pixels.data());
  };
  cv::Mat left = levels_of(images.left), right = levels_of(images.right);
  const auto band = narrow_band({&left, &right}, 8);
  if (!band) return;
  stretch<std::uint8_t>(left, *band, left);
  stretch<std::uint8_t>(right, *band, right);
  if (auto note = faint_note(*band)) images.notes.push_back(*std::move(note));
}

}  // namespace flies
