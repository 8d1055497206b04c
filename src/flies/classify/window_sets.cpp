#include "flies/classify/window_sets.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

namespace flies {
namespace {

/// Windows this close to the raster are on it, in pixels of the model's window: far less than a person moves in it.
constexpr double kOnRaster_px = 0.05;
/// Sets that spread farther than this, in strides, would compute more than their windows share.
constexpr int kMaxSpread = 24;

/// In one window.
int blocks_along(int window_px, const HogGeometry& geometry) {
  return (window_px - geometry.block_px) / geometry.stride_px + 1;
}

struct Offset {
  int column = 0, row = 0;
};

/// Where the window lies on the raster of another one of its size.
std::optional<Offset> offset_from(const ImageBox& window, const ImageBox& first, const WindowRaster& raster) {
  const double scale = first.height_px / raster.height_px;
  const double stride_px = raster.stride_px * scale;
  if (std::abs(window.height_px - first.height_px) > kOnRaster_px * scale ||
      std::abs(window.width_px - first.width_px) > kOnRaster_px * scale)
    return {};
  const double across = (window.u_px - first.u_px) / stride_px, down = (window.v_px - first.v_px) / stride_px;
  const auto on_raster = [&](double steps) {
    return std::abs(steps) <= kMaxSpread && std::abs(steps - std::round(steps)) * raster.stride_px <= kOnRaster_px;
  };
  if (!on_raster(across) || !on_raster(down)) return {};
  return Offset{static_cast<int>(std::lround(across)), static_cast<int>(std::lround(down))};
}

/// Counts places from the top left corner of all windows.
void close_set(WindowSet& set, const ImageBox& first, const WindowRaster& raster) {
  const auto shift_to_zero = [](std::vector<int>& offsets) {
    const auto [low, high] = std::minmax_element(offsets.begin(), offsets.end());
    const int lowest = *low, spread = *high - *low;
    for (int& offset : offsets) offset -= lowest;
    return std::pair(lowest, spread);
  };
  const double scale_u = first.width_px / raster.width_px, scale_v = first.height_px / raster.height_px;
  const auto [left, across] = shift_to_zero(set.column);
  const auto [top, down] = shift_to_zero(set.row);
  set.columns = across + 1;
  set.rows = down + 1;
  set.region = {first.u_px + left * raster.stride_px * scale_u, first.v_px + top * raster.stride_px * scale_v,
                first.width_px + across * raster.stride_px * scale_u,
                first.height_px + down * raster.stride_px * scale_v};
}

}  // namespace

std::vector<WindowSet> window_sets(std::span<const ImageBox> windows, const GrayView& image,
                                   const WindowRaster& raster) {
  std::vector<WindowSet> sets;
  std::vector<ImageBox> firsts;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (!is_worth_a_look(windows[i], image)) continue;
    auto offset = sets.empty() ? std::nullopt : offset_from(windows[i], firsts.back(), raster);
    if (!offset) {
      sets.emplace_back();
      firsts.push_back(windows[i]);
      offset.emplace();
    }
    sets.back().windows.push_back(i);
    sets.back().column.push_back(offset->column);
    sets.back().row.push_back(offset->row);
  }
  for (std::size_t i = 0; i < sets.size(); ++i) close_set(sets[i], firsts[i], raster);
  return sets;
}

HogBlocks blocks_of(const WindowSet& set, const GrayView& image, const HogGeometry& geometry) {
  const int width_px = geometry.window_width_px + (set.columns - 1) * geometry.stride_px;
  const int height_px = geometry.window_height_px + (set.rows - 1) * geometry.stride_px;
  const double margin_u_px = kHogMargin_px * set.region.width_px / width_px;
  const double margin_v_px = kHogMargin_px * set.region.height_px / height_px;
  const ImageBox with_margin{set.region.u_px - margin_u_px, set.region.v_px - margin_v_px,
                             set.region.width_px + 2.0 * margin_u_px, set.region.height_px + 2.0 * margin_v_px};
  return hog_blocks(resample(image, with_margin, width_px + 2 * kHogMargin_px, height_px + 2 * kHogMargin_px),
                    geometry);
}

void FeaturePieces::copy_to(float* features) const {
  for (std::size_t piece = 0; piece < count; ++piece, features += size)
    std::copy_n(first + piece * stride, size, features);
}

FeaturePieces features_of(const HogBlocks& blocks, const WindowSet& set, std::size_t i, const HogGeometry& geometry) {
  return {blocks.block(set.column[i], set.row[i]),
          static_cast<std::size_t>(blocks_along(geometry.window_height_px, geometry)) * blocks.block_size,
          static_cast<std::size_t>(blocks.rows) * blocks.block_size,
          static_cast<std::size_t>(blocks_along(geometry.window_width_px, geometry))};
}

}  // namespace flies
