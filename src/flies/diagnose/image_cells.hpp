#pragma once

#include <array>
#include <cstddef>

#include "flies/core/gray_view.hpp"

namespace flies {

/// A coarse grid over an image, for what can be said of its parts.
constexpr int kCellGridColumns = 20, kCellGridRows = 8;
using CellGrid = std::array<bool, static_cast<std::size_t>(kCellGridColumns) * kCellGridRows>;

constexpr std::size_t cell_index(int row, int column) {
  return static_cast<std::size_t>(row) * kCellGridColumns + static_cast<std::size_t>(column);
}

/// Standard deviation of the grey levels of a cell that can be matched.
constexpr double kTexture_gray = 3.0;

/// Which cells show anything to match, row by row.
inline CellGrid textured_cells(const GrayView& image) {
  CellGrid textured{};
  for (int row = 0; row < kCellGridRows; ++row)
    for (int column = 0; column < kCellGridColumns; ++column) {
      const int first_v = image.height_px * row / kCellGridRows, end_v = image.height_px * (row + 1) / kCellGridRows;
      const int first_u = image.width_px * column / kCellGridColumns,
                end_u = image.width_px * (column + 1) / kCellGridColumns;
      double sum = 0.0, squares = 0.0;
      for (int v = first_v; v < end_v; ++v)
        for (int u = first_u; u < end_u; ++u) {
          const int level = image.row(v)[u];
          sum += level;
          squares += level * level;
        }
      const double pixels = (end_v - first_v) * (end_u - first_u);
      if (pixels > 0.0)
        textured[cell_index(row, column)] =
            squares / pixels - (sum / pixels) * (sum / pixels) >= kTexture_gray * kTexture_gray;
    }
  return textured;
}

}  // namespace flies
