#include "flies/diagnose/image_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "flies/core/quantile.hpp"
#include "flies/diagnose/image_cells.hpp"

namespace flies {
namespace {

constexpr int kWhite_gray = 250;
constexpr double kMostWhite = 0.02;  ///< of a cell: what is cut off does not vary
constexpr double kCalm = 0.25;       ///< of the cells

/// Weights 1 -2 1, -2 4 -2, 1 -2 1; of noise alone, 6 times its standard deviation.
int laplacian(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below) {
  return above[-1] - 2 * above[0] + above[1] - 2 * row[-1] + 4 * row[0] - 2 * row[1] + below[-1] - 2 * below[0] +
         below[1];
}

struct Cell {
  double noise_gray = 0.0, contrast_gray = 0.0;
  bool is_cut_off = false;
};

Cell cell_of(const GrayView& image, int first_u, int end_u, int first_v, int end_v) {
  std::int64_t sum = 0, squares = 0, changes = 0, white = 0;
  for (int v = first_v; v < end_v; ++v) {
    const std::uint8_t *above = image.row(v - 1), *row = image.row(v), *below = image.row(v + 1);
    for (int u = first_u; u < end_u; ++u) {
      sum += row[u];
      squares += row[u] * row[u];
      white += row[u] >= kWhite_gray;
      changes += std::abs(laplacian(above + u, row + u, below + u));
    }
  }
  const double pixels = static_cast<double>(end_u - first_u) * (end_v - first_v);
  const double mean = static_cast<double>(sum) / pixels;
  const double variance = static_cast<double>(squares) / pixels - mean * mean;
  // The mean of a normal variable without its sign is sqrt(2 / pi) of its standard deviation.
  return {std::sqrt(std::numbers::pi / 2.0) * static_cast<double>(changes) / (6.0 * pixels),
          std::sqrt(std::max(0.0, variance)), static_cast<double>(white) > kMostWhite * pixels};
}

}  // namespace

double ImageNoise::contrast_to_noise() const {
  return noise_gray > 0.0 ? contrast_gray / noise_gray : std::numeric_limits<double>::infinity();
}

bool ImageNoise::is_much() const {
  return noise_gray >= kMuchNoise_gray && contrast_to_noise() < kLeastContrastToNoise;
}

ImageNoise measure_noise(const GrayView& image) {
  std::vector<double> noise, contrast;
  const int rows = image.height_px - 2, columns = image.width_px - 2;  // with a pixel all around
  for (int row = 0; row < kCellGridRows; ++row)
    for (int column = 0; column < kCellGridColumns; ++column) {
      const int first_v = 1 + rows * row / kCellGridRows, end_v = 1 + rows * (row + 1) / kCellGridRows;
      const int first_u = 1 + columns * column / kCellGridColumns,
                end_u = 1 + columns * (column + 1) / kCellGridColumns;
      if (first_u == end_u || first_v == end_v) continue;
      const Cell cell = cell_of(image, first_u, end_u, first_v, end_v);
      if (!(cell.contrast_gray > 0.0)) continue;  // one level all over: masked out, or beyond what the sensor can tell
      contrast.push_back(cell.contrast_gray);
      if (!cell.is_cut_off) noise.push_back(cell.noise_gray);
    }
  return {noise.empty() ? 0.0 : quantile(noise, kCalm), contrast.empty() ? 0.0 : upper_median(contrast)};
}

ImageNoise median_noise(std::vector<ImageNoise> images) {
  if (images.empty()) return {};
  const auto middle = images.begin() + static_cast<std::ptrdiff_t>(images.size() / 2);
  std::nth_element(images.begin(), middle, images.end(), [](const ImageNoise& a, const ImageNoise& b) {
    return a.contrast_to_noise() < b.contrast_to_noise();
  });
  return *middle;
}

}  // namespace flies
