#include "flies/diagnose/image_borders.hpp"

#include <algorithm>
#include <cstdint>

namespace flies {
namespace {

/// Levels of a border that was compressed, as JPEG does it.
constexpr int kOneLevel_gray = 6;

bool is_of_one_level(const GrayView& image, int first_u, int end_u, int first_v, int end_v) {
  std::uint8_t least = 255, most = 0;
  for (int v = first_v; v < end_v; ++v) {
    const auto [low, high] = std::minmax_element(image.row(v) + first_u, image.row(v) + end_u);
    least = std::min(least, *low);
    most = std::max(most, *high);
  }
  return most - least <= kOneLevel_gray;
}

}  // namespace

ImageBorders find_borders(const RectifiedPair& pair) {
  const int width_px = pair.left.width_px, height_px = pair.left.height_px;
  ImageBorders borders;
  const auto row_is_empty = [&](int v) {
    return is_of_one_level(pair.left, 0, width_px, v, v + 1) && is_of_one_level(pair.right, 0, width_px, v, v + 1);
  };
  while (borders.top_px < height_px && row_is_empty(borders.top_px)) ++borders.top_px;
  if (borders.top_px == height_px) return {};
  while (row_is_empty(height_px - 1 - borders.bottom_px)) ++borders.bottom_px;
  const int first_v = borders.top_px, end_v = height_px - borders.bottom_px;
  const auto column_is_empty = [&](int u) {
    return is_of_one_level(pair.left, u, u + 1, first_v, end_v) &&
           is_of_one_level(pair.right, u, u + 1, first_v, end_v);
  };
  while (borders.left_px < width_px && column_is_empty(borders.left_px)) ++borders.left_px;
  if (borders.left_px == width_px) return {};
  while (column_is_empty(width_px - 1 - borders.right_px)) ++borders.right_px;
  return borders;
}

}  // namespace flies
