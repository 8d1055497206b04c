#include "flies/train/weights_picture.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace flies {
namespace {

constexpr int kCellOnPaper_px = 32;
constexpr int kGap_px = 16;

/// Weights of all blocks summed by cell and orientation.
struct CellWeights {
  int columns = 0, rows = 0, bins = 0;
  std::vector<double> values;

  double& at(int column, int row, int bin) {
    return values[static_cast<std::size_t>((column * rows + row) * bins + bin)];
  }
};

CellWeights sum_by_cell(std::span<const float> weights, const HogGeometry& hog) {
  CellWeights sums{hog.window_width_px / hog.cell_px, hog.window_height_px / hog.cell_px, hog.bins, {}};
  sums.values.resize(static_cast<std::size_t>(sums.columns * sums.rows * sums.bins));
  const int cells = hog.block_px / hog.cell_px;
  std::size_t k = 0;
  for (int u = 0; u + hog.block_px <= hog.window_width_px; u += hog.stride_px)
    for (int v = 0; v + hog.block_px <= hog.window_height_px; v += hog.stride_px)
      for (int column = 0; column < cells; ++column)
        for (int row = 0; row < cells; ++row)
          for (int bin = 0; bin < hog.bins; ++bin)
            sums.at(u / hog.cell_px + column, v / hog.cell_px + row, bin) += weights[k++];
  return sums;
}

/// Strokes of the weights with this sign. Weak ones first, so that strong ones lie on top.
void draw_strokes(CellWeights& sums, double sign, cv::Mat picture) {
  double largest = 1e-12;
  for (const double value : sums.values) largest = std::max(largest, std::abs(value));
  std::vector<int> order(sums.values.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return sign * sums.values[static_cast<std::size_t>(a)] < sign * sums.values[static_cast<std::size_t>(b)];
  });
  for (const int i : order) {
    const double strength = sign * sums.values[static_cast<std::size_t>(i)] / largest;
    if (strength <= 0.0) continue;
    const int cell = i / sums.bins, column = cell / sums.rows, row = cell % sums.rows;
    // Gradients of bin b point (b + 1/2) * 180 degrees / bins from the horizontal; the edge lies across.
    const double across = (i % sums.bins + 0.5) * std::numbers::pi / sums.bins + std::numbers::pi / 2.0;
    const cv::Point2d centre((column + 0.5) * kCellOnPaper_px, (row + 0.5) * kCellOnPaper_px);
    const cv::Point2d half(0.48 * kCellOnPaper_px * std::cos(across), 0.48 * kCellOnPaper_px * std::sin(across));
    const double level = 255.0 * std::sqrt(strength);
    cv::line(picture, centre - half, centre + half, {level, level, level}, 2, cv::LINE_AA);
  }
}

}  // namespace

cv::Mat draw_weights(std::span<const float> weights, const HogGeometry& hog) {
  assert(weights.size() == feature_count(hog));
  CellWeights sums = sum_by_cell(weights, hog);
  const int width_px = sums.columns * kCellOnPaper_px, height_px = sums.rows * kCellOnPaper_px;
  cv::Mat picture(height_px, 2 * width_px + kGap_px, CV_8UC3, cv::Scalar::all(255));
  const cv::Rect left(0, 0, width_px, height_px), right(width_px + kGap_px, 0, width_px, height_px);
  picture(left).setTo(0);
  picture(right).setTo(0);
  draw_strokes(sums, 1.0, picture(left));
  draw_strokes(sums, -1.0, picture(right));
  return picture;
}

}  // namespace flies
