#pragma once

#include <cstddef>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/results.hpp"

namespace flies {

/// Grey levels in single precision, row by row without padding.
struct FloatImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> values;

  const float* row(int v) const { return values.data() + static_cast<std::ptrdiff_t>(v) * width_px; }
  float* row(int v) { return values.data() + static_cast<std::ptrdiff_t>(v) * width_px; }
};

/// As many pixels can be appended to what `resample` returns without its memory being moved: features read vectors
/// behind the last one.
inline constexpr std::size_t kSparePixels = 32;

/// A region of an image, resized to this many pixels: each is the mean of the area that it covers where the region
/// shrinks, and interpolated linearly where it grows. Where the region leaves the image, the border pixels are
/// repeated.
/// @param region with an area; pixel (u, v) of the image covers u to u + 1 and v to v + 1
FloatImage resample(const GrayView& image, const ImageBox& region, int width_px, int height_px);

}  // namespace flies
