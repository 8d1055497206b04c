#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "flies/classify/hog_blocks.hpp"

namespace flies {

/// Sizes in the pixels that windows are resized to.
struct WindowRaster {
  int width_px = 0, height_px = 0;  ///< of a window
  int stride_px = 1;                ///< between places at which windows share what is computed

  static WindowRaster of(const HogGeometry& geometry) {
    return {geometry.window_width_px, geometry.window_height_px, geometry.stride_px};
  }
};

/// Windows of one size on one raster: their features are computed once for all.
struct WindowSet {
  ImageBox region;                   ///< what they cover together
  int columns = 0, rows = 0;         ///< places for windows in the region
  std::vector<std::size_t> windows;  ///< indices
  std::vector<int> column, row;      ///< the place of each window
};

/// Divides windows into sets: those that follow each other, are of one size, and lie on one raster.
/// @param windows those that are not `is_worth_a_look` are left out
std::vector<WindowSet> window_sets(std::span<const ImageBox> windows, const GrayView& image,
                                   const WindowRaster& raster);

/// The blocks of the region.
HogBlocks blocks_of(const WindowSet& set, const GrayView& image, const HogGeometry& geometry);

/// The features of a window where they lie among the blocks: a piece for every column of blocks.
struct FeaturePieces {
  const float* first = nullptr;
  std::size_t size = 0, stride = 0, count = 0;

  void copy_to(float* features) const;
};

/// Those of the i-th window of the set.
FeaturePieces features_of(const HogBlocks& blocks, const WindowSet& set, std::size_t i, const HogGeometry& geometry);

}  // namespace flies
