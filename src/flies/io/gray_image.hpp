#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"

namespace flies {

/// An 8-bit grey image that owns its pixels: row-major, without padding.
struct GrayImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> pixels;  ///< width_px * height_px values

  /// Valid as long as `pixels` is neither resized nor destroyed.
  GrayView view() const { return {pixels.data(), width_px, height_px, width_px}; }
};

/// The two images of a pair, owned.
struct GrayPair {
  GrayImage left;
  GrayImage right;
  int bit_depth = 8;  ///< bits of the files that were kept apart: 8, or 9..16 for 16-bit files (see `load_pair`)
  std::vector<std::string> notes = {};  ///< sentences for the user: what was assumed of the files

  /// Valid as long as the pair is.
  RectifiedPair view() const { return {left.view(), right.view()}; }
};

}  // namespace flies
