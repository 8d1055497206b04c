#pragma once

#include <cstddef>
#include <vector>

#include "flies/classify/hog.hpp"
#include "flies/classify/resample.hpp"

namespace flies {

/// The normalised blocks of a picture, one every `stride_px` both ways: what all windows share whose corners lie on
/// that raster. By columns, so that the blocks of a window are one stretch per column.
struct HogBlocks {
  int columns = 0;
  int rows = 0;
  std::size_t block_size = 0;  ///< cells of a block times bins
  std::vector<float> values;

  const float* block(int column, int row) const { return values.data() + start(column, row); }
  float* block(int column, int row) { return values.data() + start(column, row); }

  std::size_t start(int column, int row) const {
    return (static_cast<std::size_t>(column) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row)) *
           block_size;
  }
};

/// The blocks of an image.
/// @param pixels grey levels, 0 to 255; `kHogMargin_px` wider on every side than what the blocks cover, which must be
///               whole strides. Used up.
HogBlocks hog_blocks(FloatImage pixels, const HogGeometry& geometry);

}  // namespace flies
