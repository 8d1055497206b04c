#include "flies/io/packed_yuv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <opencv2/core.hpp>

namespace flies::detail {
namespace {

constexpr double kNoColor_gray = 128.0;
/// Of colour from that level, over the spread of the brightness: 0.4 at most in colourful pictures.
constexpr double kMostColor = 0.6, kMostColorOfPlanes = 0.45;
constexpr double kJumpBeside = 2.5, kJumpBelow = 2.2;
constexpr double kLeastStep_gray = 1.0;  // what is the same throughout jumps by noise

/// Every so many rows tell enough.
constexpr int kRowStep = 4;

/// Mean and spread of levels.
class Spread {
 public:
  void add(int level) {
    const double above = level - kNoColor_gray;
    sum_ += above;
    squares_ += above * above;
    ++count_;
  }
  /// From the level of no colour.
  double from_no_color() const { return std::sqrt(squares_ / std::max(1.0, count_)); }
  double deviation() const {
    const double mean = sum_ / std::max(1.0, count_);
    return std::sqrt(std::max(0.0, squares_ / std::max(1.0, count_) - mean * mean));
  }

 private:
  double sum_ = 0.0, squares_ = 0.0, count_ = 0.0;
};

/// Whether brightness stands in every other column.
/// @param first column of it, 0 or 1
bool has_luma_in_columns(const cv::Mat& levels, int first) {
  Spread luma, color;
  double beside = 0.0, along = 0.0;
  for (int v = 0; v < levels.rows; v += kRowStep) {
    const std::uint8_t* row = levels.ptr<std::uint8_t>(v);
    for (int u = 0; u + 3 < levels.cols; u += 2) {
      const int here = row[u + first], other = row[u + 1 - first], next = row[u + 2 + first];
      luma.add(here);
      color.add(other);
      beside += std::abs(here - other);
      along += std::abs(here - next);
    }
  }
  const double samples = static_cast<double>((levels.rows + kRowStep - 1) / kRowStep) * (levels.cols / 2);
  return color.from_no_color() < kMostColor * luma.deviation() &&
         beside > kJumpBeside * std::max(along, kLeastStep_gray * samples);
}

/// Mean change from one row to the next.
double row_step(const cv::Mat& levels, int v) {
  return cv::norm(levels.row(v), levels.row(v + 1), cv::NORM_L1) / levels.cols;
}

bool has_luma_in_upper_part(const cv::Mat& levels) {
  constexpr int kRowsAbove = 8;
  const int luma_rows = levels.rows / 3 * 2;
  if (levels.rows % 3 != 0 || levels.cols % 2 != 0 || luma_rows <= kRowsAbove) return false;
  double step = 0.0;
  for (int v = luma_rows - 1 - kRowsAbove; v < luma_rows - 1; ++v) step += row_step(levels, v) / kRowsAbove;
  if (row_step(levels, luma_rows - 1) <= kJumpBelow * std::max(step, kLeastStep_gray)) return false;
  Spread luma, color;
  for (int v = 0; v < levels.rows; v += kRowStep)
    for (int u = 0; u < levels.cols; ++u) (v < luma_rows ? luma : color).add(levels.at<std::uint8_t>(v, u));
  return color.from_no_color() < kMostColorOfPlanes * luma.deviation();
}

}  // namespace

std::optional<YuvLayout> recognise_yuv(const cv::Mat& levels) {
  if (levels.type() != CV_8UC1) return std::nullopt;
  if (levels.cols % 2 == 0 && has_luma_in_columns(levels, 0)) return YuvLayout::yuyv;
  if (levels.cols % 2 == 0 && has_luma_in_columns(levels, 1)) return YuvLayout::uyvy;
  if (has_luma_in_upper_part(levels)) return YuvLayout::planes;
  return std::nullopt;
}

cv::Mat luma_of(const cv::Mat& levels, YuvLayout layout) {
  if (layout == YuvLayout::planes) return levels.rowRange(0, levels.rows / 3 * 2).clone();
  // A row of pairs of pixels, as pixels of two channels.
  cv::Mat luma;
  cv::extractChannel((levels.isContinuous() ? levels : levels.clone()).reshape(2), luma,
                     layout == YuvLayout::yuyv ? 0 : 1);
  return luma;
}

std::string note_on_yuv(YuvLayout layout, int width_px, int height_px) {
  const auto what =
      layout == YuvLayout::planes ? "the lower third of the images is the colour of YUV pictures (NV12 or I420)"
      : layout == YuvLayout::yuyv ? "every other column of the images is the colour of YUV pictures (YUYV)"
                                  : "every other column of the images is the colour of YUV pictures (UYVY)";
  return fmt::format("{}, saved as if it were grey levels: it is left out, which leaves {} x {} px", what, width_px,
                     height_px);
}

}  // namespace flies::detail
