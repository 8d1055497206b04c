#include "flies/io/mosaic.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace flies {
namespace {

/// Differences of the diagonals in squares of 2 x 2 pixels, row by row.
struct Squares {
  int columns = 0, rows = 0;
  std::vector<std::int16_t> differences;
  std::int64_t falling = 0, rising = 0;  ///< sums of the differences along either diagonal, without sign

  int at(int u, int v) const { return differences[static_cast<std::size_t>(v * columns + u)]; }
};

Squares squares_of(const GrayView& image) {
  constexpr int kMost_gray = 40;  // single strong edges must not decide
  Squares squares;
  squares.columns = image.width_px / 2;
  squares.rows = image.height_px / 2;
  squares.differences.reserve(static_cast<std::size_t>(squares.columns) * static_cast<std::size_t>(squares.rows));
  for (int v = 0; v < squares.rows; ++v) {
    const std::uint8_t *above = image.row(2 * v), *below = image.row(2 * v + 1);
    for (int u = 0; u < squares.columns; ++u, above += 2, below += 2) {
      const int difference = above[0] - above[1] - below[0] + below[1];
      squares.differences.push_back(static_cast<std::int16_t>(std::clamp(difference, -kMost_gray, kMost_gray)));
      squares.falling += std::abs(above[0] - below[1]);
      squares.rising += std::abs(above[1] - below[0]);
    }
  }
  return squares;
}

/// Correlation of the differences with those so many squares farther to the right and down.
double correlation(const Squares& squares, int right, int down) {
  std::int64_t product = 0, here = 0, there = 0;
  for (int v = 0; v + down < squares.rows; ++v)
    for (int u = 0; u + right < squares.columns; ++u) {
      const std::int64_t a = squares.at(u, v), b = squares.at(u + right, v + down);
      product += a * b;
      here += a * a;
      there += b * b;
    }
  const double scale = std::sqrt(static_cast<double>(here) * static_cast<double>(there));
  return scale > 0.0 ? static_cast<double>(product) / scale : 0.0;
}

}  // namespace

std::optional<BayerPattern> bayer_pattern_of(const std::string& word) {
  if (word == "rggb") return BayerPattern::rggb;
  if (word == "bggr") return BayerPattern::bggr;
  if (word == "grbg") return BayerPattern::grbg;
  if (word == "gbrg") return BayerPattern::gbrg;
  return std::nullopt;
}

cv::Mat demosaiced(const cv::Mat& mosaic, BayerPattern pattern) {
  assert(mosaic.type() == CV_8UC1 || mosaic.type() == CV_16UC1);
  // OpenCV names patterns by the second and third pixels of the second row.
  const int code = pattern == BayerPattern::rggb   ? cv::COLOR_BayerBG2GRAY
                   : pattern == BayerPattern::bggr ? cv::COLOR_BayerRG2GRAY
                   : pattern == BayerPattern::grbg ? cv::COLOR_BayerGB2GRAY
                                                   : cv::COLOR_BayerGR2GRAY;
  cv::Mat gray;
  cv::cvtColor(mosaic, gray, code);
  return gray;
}

GrayImage demosaiced(GrayImage mosaic, BayerPattern pattern) {
  const cv::Mat gray = demosaiced(cv::Mat(mosaic.height_px, mosaic.width_px, CV_8U, mosaic.pixels.data()), pattern);
  mosaic.pixels.assign(gray.begin<std::uint8_t>(), gray.end<std::uint8_t>());
  return mosaic;
}

std::optional<MosaicGreens> recognise_mosaic(const GrayView& image) {
  constexpr double kLeastCorrelation = 0.15;
  constexpr double kLeastRatio = 1.25;  // the diagonal of red and blue over that of both greens
  const Squares squares = squares_of(image);
  const double least = std::min({correlation(squares, 1, 0), correlation(squares, 0, 1), correlation(squares, 2, 2)});
  if (least < kLeastCorrelation) return std::nullopt;
  const auto falling = static_cast<double>(squares.falling), rising = static_cast<double>(squares.rising);
  if (falling > kLeastRatio * rising) return MosaicGreens::beside;
  if (rising > kLeastRatio * falling) return MosaicGreens::first;
  return std::nullopt;
}

MosaicGreens greens_of(BayerPattern pattern) {
  return pattern == BayerPattern::rggb || pattern == BayerPattern::bggr ? MosaicGreens::beside : MosaicGreens::first;
}

const char* patterns_of(MosaicGreens greens) {
  return greens == MosaicGreens::beside ? "rggb or bggr" : "grbg or gbrg";
}

std::optional<std::string> mosaic_note(const RectifiedPair& pair) {
  auto greens = recognise_mosaic(pair.left);
  if (!greens) greens = recognise_mosaic(pair.right);
  if (!greens) return std::nullopt;
  return std::string(
             "the images look like the raw mosaic of a colour camera (Bayer), which is matched badly: --bayer ") +
         patterns_of(*greens) + " converts it to grey";
}

}  // namespace flies
