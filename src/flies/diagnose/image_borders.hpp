#pragma once

#include "flies/core/gray_view.hpp"

namespace flies {

/// Rows and columns at the edges of both images that are of one level throughout: what padding and letterboxing add.
struct ImageBorders {
  int left_px = 0, right_px = 0, top_px = 0, bottom_px = 0;

  bool any() const { return left_px + right_px + top_px + bottom_px > 0; }
};

/// @returns none for a pair that is of one level altogether
ImageBorders find_borders(const RectifiedPair& pair);

}  // namespace flies
