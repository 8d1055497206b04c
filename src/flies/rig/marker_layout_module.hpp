#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "flies/rig/board.hpp"

namespace flies {

/// Markers as an image shows them: four corners each, clockwise from the upper left one of the marker.
struct Markers {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
};

/// Where a board's markers stand, and how large they are printed.
struct MarkerLayout {
  bool is_legacy = false;   ///< charuco: the upper left square is white
  std::string misfit = {};  ///< the markers say that the board is another one; empty when they fit or tell nothing
};

/// Whether markers stand where the board has them: from their middles alone, which no lens moves by half a square.
MarkerLayout layout_of(const Markers& markers, const Board& board);

/// Markers in the rows of white squares above this one; with `is_legacy` the first square is white.
int markers_above(const Board& board, int row, bool is_legacy);

}  // namespace flies
