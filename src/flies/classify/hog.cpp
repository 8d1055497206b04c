#include "flies/classify/hog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "flies/classify/hog_blocks.hpp"
#include "flies/classify/window_sets.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

/// Larger windows than this are a mistake in the file, and would ask for absurd amounts of memory.
constexpr int kMaxWindow_px = 1024;
constexpr int kMaxBins = 64;
/// Below this there is nothing to see: resizing would invent all pixels.
constexpr double kMinWindow_px = 4.0;
/// Beyond this many times the image the window holds nothing but repeated border.
constexpr double kMaxWindowPerImage = 8.0;

}  // namespace

std::size_t feature_count(const HogGeometry& geometry) {
  const auto blocks = [&](int window_px) { return (window_px - geometry.block_px) / geometry.stride_px + 1; };
  const int cells = geometry.block_px / geometry.cell_px;
  return static_cast<std::size_t>(blocks(geometry.window_width_px)) *
         static_cast<std::size_t>(blocks(geometry.window_height_px)) *
         static_cast<std::size_t>(cells * cells * geometry.bins);
}

void check_hog_geometry(const HogGeometry& geometry, const std::string& source) {
  const auto require = [&](bool ok, const char* field, int found, const std::string& allowed) {
    if (!ok) throw InputError(source, field, fmt::format("found {}, expected {}", found, allowed));
  };
  const int height = geometry.window_height_px, width = geometry.window_width_px;
  require(height >= 8 && height <= kMaxWindow_px, "hog.window_height_px", height,
          fmt::format("8 to {}", kMaxWindow_px));
  require(2 * width == height, "hog.window_width_px", width,
          fmt::format("half of window_height_px, which is {}", height));
  require(geometry.block_px >= 1 && geometry.block_px <= width, "hog.block_px", geometry.block_px,
          fmt::format("1 to {}", width));
  require(geometry.stride_px >= 1 && (width - geometry.block_px) % geometry.stride_px == 0 &&
              (height - geometry.block_px) % geometry.stride_px == 0,
          "hog.stride_px", geometry.stride_px, "a step that tiles the window with blocks");
  require(geometry.cell_px >= 1 && geometry.block_px % geometry.cell_px == 0, "hog.cell_px", geometry.cell_px,
          fmt::format("a divisor of block_px, which is {}", geometry.block_px));
  require(geometry.bins >= 2 && geometry.bins <= kMaxBins, "hog.bins", geometry.bins, fmt::format("2 to {}", kMaxBins));
}

void hog_features(const GrayView& window, const HogGeometry& geometry, std::span<float> features) {
  assert(window.width_px == geometry.window_width_px + 2 * kHogMargin_px);
  assert(window.height_px == geometry.window_height_px + 2 * kHogMargin_px);
  assert(features.size() == feature_count(geometry));
  FloatImage pixels{window.width_px, window.height_px, {}};
  for (int v = 0; v < window.height_px; ++v)
    pixels.values.insert(pixels.values.end(), window.row(v), window.row(v) + window.width_px);
  const HogBlocks blocks = hog_blocks(std::move(pixels), geometry);
  std::copy(blocks.values.begin(), blocks.values.end(), features.begin());
}

bool is_worth_a_look(const ImageBox& window, const GrayView& image) {
  const bool finite = std::isfinite(window.u_px) && std::isfinite(window.v_px) && std::isfinite(window.width_px) &&
                      std::isfinite(window.height_px);
  const bool sized = window.width_px >= kMinWindow_px / 2.0 && window.height_px >= kMinWindow_px &&
                     window.width_px <= kMaxWindowPerImage * image.width_px &&
                     window.height_px <= kMaxWindowPerImage * image.height_px;
  return finite && sized && window.u_px < image.width_px && window.v_px < image.height_px &&
         window.u_px + window.width_px > 0.0 && window.v_px + window.height_px > 0.0;
}

void window_features(const GrayView& image, const ImageBox& window, const HogGeometry& geometry,
                     std::span<float> features) {
  assert(is_worth_a_look(window, image));
  const auto set = window_sets({&window, 1}, image, WindowRaster::of(geometry));
  assert(features.size() == feature_count(geometry));
  features_of(blocks_of(set.front(), image, geometry), set.front(), 0, geometry).copy_to(features.data());
}

}  // namespace flies
