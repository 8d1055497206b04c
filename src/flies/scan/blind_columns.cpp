#include "flies/scan/blind_columns.hpp"

#include <algorithm>
#include <cstddef>

#include "flies/core/pair_check.hpp"

namespace flies {
namespace {

/// A block is as wide as some columns of cells and shows something when its grey levels deviate by more than noise
/// does.
constexpr int kColumnsOfBlock = 4;
constexpr int kBlockWidth_px = kColumnsOfBlock * kernels::kCellColumns, kBlockHeight_px = 16, kRowsApart = 2;
constexpr double kTexture_gray = 3.0;

bool shows_something(const GrayView& image, int first_u, int first_v, int end_v) {
  const int end_u = std::min(first_u + kBlockWidth_px, image.width_px);
  long sum = 0, squares = 0, pixels = 0;
  for (int v = first_v; v < end_v; v += kRowsApart)
    for (int u = first_u; u < end_u; ++u) {
      const int level = image.row(v)[u];
      sum += level;
      squares += level * level;
      ++pixels;
    }
  if (pixels == 0) return false;
  const double mean = static_cast<double>(sum) / static_cast<double>(pixels);
  return static_cast<double>(squares) / static_cast<double>(pixels) - mean * mean > kTexture_gray * kTexture_gray;
}

/// One entry a block of columns, from left to right: whether any block of it shows something.
std::vector<bool> textured_blocks(const GrayView& image, int top_row, int bottom_row) {
  std::vector<bool> textured;
  for (int first_u = 0; first_u < image.width_px; first_u += kBlockWidth_px) {
    bool found = false;
    for (int end_v = bottom_row + 1; end_v > top_row && !found; end_v -= kBlockHeight_px)
      found = shows_something(image, first_u, std::max(top_row, end_v - kBlockHeight_px), end_v);
    textured.push_back(found);
  }
  return textured;
}

/// Whether any block from one to another, both included, is textured; those outside count as the nearest inside.
bool any_textured(const std::vector<bool>& textured, int first, int last) {
  const int most = static_cast<int>(textured.size()) - 1;
  first = std::clamp(first, 0, most);
  last = std::clamp(last, first, most);
  return std::find(textured.begin() + first, textured.begin() + last + 1, true) != textured.begin() + last + 1;
}

}  // namespace

std::vector<bool> blind_columns(const RectifiedPair& pair, const CellLayout& layout, int row_step) {
  std::vector<bool> blind(static_cast<std::size_t>(layout.columns), false);
  if (layout.bands == 0) return blind;
  const int top_row = std::max(0, layout.bottom_row - layout.bands * kernels::kCellRows * row_step + 1);
  const auto left = textured_blocks(pair.left, top_row, layout.bottom_row);
  const auto right = textured_blocks(pair.right, top_row, layout.bottom_row);
  const int farthest_px = layout.nearest_px - layout.disparities + 1;
  for (int column = 0; column < layout.columns; ++column) {
    const int u = column * kernels::kCellColumns;
    const int block = u / kBlockWidth_px;
    const int first = (u - layout.nearest_px) / kBlockWidth_px, last = (u - farthest_px) / kBlockWidth_px;
    blind[static_cast<std::size_t>(column)] =
        !any_textured(left, block - 1, block + 1) || !any_textured(right, first, last);
  }
  return blind;
}

std::vector<bool> too_near_columns(const RectifiedPair& pair, const CellLayout& layout, const Projection& projection,
                                   const RoadPlane& road) {
  constexpr double kTolerance = 1.03;  // the nearest disparities are still told by their neighbours
  const auto parts = parts_nearer_than(pair, [&](double v_px) {
    return std::max(kTolerance * layout.nearest_px, nearer_than_road_px(projection, road, pair.left.width_px, v_px));
  });
  std::vector<bool> near(static_cast<std::size_t>(layout.columns), false);
  for (int column = 0; column < layout.columns; ++column) {
    const double share = layout.middle_u_px(column) / pair.left.width_px;
    const auto part = static_cast<std::size_t>(share * static_cast<double>(parts.size()));
    near[static_cast<std::size_t>(column)] = parts[std::min(part, parts.size() - 1)];
  }
  return near;
}

}  // namespace flies
