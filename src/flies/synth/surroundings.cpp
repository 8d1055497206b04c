#include "flies/synth/surroundings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "flies/core/error.hpp"

namespace flies::synth {
namespace {

constexpr int kSmallGap_px = 6;  // between two returns of a lidar, or matches of one surface
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// @returns whether anything was known
bool fill_row(float* row, int width_px) {
  int last = -1;  // known pixel
  for (int u = 0; u < width_px; ++u) {
    if (std::isnan(row[u])) continue;
    const float before = last < 0 ? row[u] : row[last];
    const bool is_small = last >= 0 && u - last <= kSmallGap_px;
    std::fill(row + last + 1, row + u, is_small ? std::max(before, row[u]) : std::min(before, row[u]));
    last = u;
  }
  if (last >= 0) std::fill(row + last + 1, row + width_px, row[last]);
  return last >= 0;
}

void fill(cv::Mat& disparity) {
  for (int v = disparity.rows - 1; v >= 0; --v) {
    if (fill_row(disparity.ptr<float>(v), disparity.cols)) continue;
    if (v + 1 < disparity.rows)
      disparity.row(v + 1).copyTo(disparity.row(v));
    else
      disparity.row(v).setTo(0.0F);
  }
}

cv::Mat moved_to_the_right_image(const cv::Mat& left) {
  cv::Mat right(left.size(), CV_32F, cv::Scalar(kUnknown));
  for (int v = 0; v < left.rows; ++v) {
    const float* from = left.ptr<float>(v);
    float* to = right.ptr<float>(v);
    for (int u = 0; u < left.cols; ++u) {
      const auto at = static_cast<int>(std::lround(static_cast<float>(u) - from[u]));
      if (at >= 0 && at < right.cols && !(to[at] >= from[u])) to[at] = from[u];
    }
  }
  fill(right);
  return right;
}

}  // namespace

Surroundings surroundings_of(std::span<const float> known, std::span<const float> otherwise, int width_px,
                             int height_px) {
  const auto pixels = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
  for (const auto& disparities : {known, otherwise})
    if (disparities.size() != pixels)
      throw InputError("disparity", "size",
                       fmt::format("found {} numbers, expected one for each of {} x {} px", disparities.size(),
                                   width_px, height_px));
  Surroundings result{cv::Mat(height_px, width_px, CV_32F), {}, cv::Mat(height_px, width_px, CV_8U)};
  for (int v = 0; v < height_px; ++v) {
    for (int u = 0; u < width_px; ++u) {
      const auto i = static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(u);
      const float value = std::isnan(known[i]) ? otherwise[i] : known[i];
      result.left.at<float>(v, u) = value;
      result.measured.at<std::uint8_t>(v, u) = std::isnan(value) ? 0 : 255;
    }
  }
  fill(result.left);
  result.right = moved_to_the_right_image(result.left);
  return result;
}

}  // namespace flies::synth
