#pragma once

#include <cstdint>
#include <vector>

#include "flies/io/gray_image.hpp"

namespace flies {

/// 8-bit colour image, red, green, blue interleaved, row-major without gaps.
struct ColorImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> pixels;  ///< 3 * width_px * height_px
};

/// Grey levels by the ITU-R BT.601 weights, as image readers compute them from colour files.
GrayImage to_gray(const ColorImage& image);

}  // namespace flies
