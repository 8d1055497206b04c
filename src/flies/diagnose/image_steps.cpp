#include "flies/diagnose/image_steps.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "flies/core/quantile.hpp"
#include "flies/diagnose/image_cells.hpp"

namespace flies {
namespace {

/// Of a part of the image, sums of absolute differences.
struct Differences {
  std::int64_t next_row = 0, second_row = 0, next_column = 0, second_column = 0;

  /// The mosaic of a colour camera and noise comb columns as well.
  bool is_combed() const {
    constexpr double kMore = 1.15;
    return static_cast<double>(next_row) > kMore * static_cast<double>(second_row) && next_column <= second_column;
  }
};

Differences differences_of(const GrayView& image, int first_u, int end_u, int first_v, int end_v) {
  Differences sums;
  for (int v = first_v; v + 2 < end_v; ++v) {
    const std::uint8_t *row = image.row(v), *next = image.row(v + 1), *second = image.row(v + 2);
    for (int u = first_u; u + 2 < end_u; ++u) {
      sums.next_row += std::abs(next[u] - row[u]);
      sums.second_row += std::abs(second[u] - row[u]);
      sums.next_column += std::abs(row[u + 1] - row[u]);
      sums.second_column += std::abs(row[u + 2] - row[u]);
    }
  }
  return sums;
}

double combed_share(const GrayView& image) {
  const CellGrid textured = textured_cells(image);
  int cells = 0, combed = 0;
  for (int row = 0; row < kCellGridRows; ++row)
    for (int column = 0; column < kCellGridColumns; ++column) {
      if (!textured[cell_index(row, column)]) continue;
      ++cells;
      combed += differences_of(image, image.width_px * column / kCellGridColumns,
                               image.width_px * (column + 1) / kCellGridColumns, image.height_px * row / kCellGridRows,
                               image.height_px * (row + 1) / kCellGridRows)
                    .is_combed();
    }
  return cells == 0 ? 0.0 : static_cast<double>(combed) / cells;
}

double sharpness(const GrayView& image) {
  constexpr int kFar_px = 4;
  std::int64_t near = 0, far = 0;
  for (int v = 0; v < image.height_px; ++v) {
    const std::uint8_t* row = image.row(v);
    for (int u = 0; u + kFar_px < image.width_px; ++u) {
      const int step = row[u + 1] - row[u], stride = row[u + kFar_px] - row[u];
      near += step * step;
      far += stride * stride;
    }
  }
  return far == 0 ? 1.0 : std::sqrt(static_cast<double>(near) / static_cast<double>(far));
}

}  // namespace

ImageSteps measure_steps(const GrayView& image) { return {combed_share(image), sharpness(image)}; }

ImageSteps median_steps(const std::vector<ImageSteps>& images) {
  if (images.empty()) return {};
  ImageSteps median;
  for (double ImageSteps::*member : {&ImageSteps::combed_share, &ImageSteps::sharpness}) {
    std::vector<double> values;
    for (const auto& image : images) values.push_back(image.*member);
    median.*member = upper_median(std::move(values));
  }
  return median;
}

}  // namespace flies
