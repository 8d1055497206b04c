#pragma once

#include <array>
#include <string>
#include <vector>

#include "flies/rig/board_tools.hpp"

namespace flies {

/// Which ninths of an image the corners reach, rows from the top.
struct Coverage {
  static constexpr int kColumns = 3, kRows = 3;
  std::array<int, kColumns * kRows> corners{};

  static constexpr int kEnough = 4;  ///< corners that a ninth takes to count as covered
  bool covers(int column, int row) const {
    return corners[static_cast<std::size_t>(row * kColumns + column)] >= kEnough;
  }
};

/// @param is_right of which image of the pairs
Coverage coverage_of(const std::vector<BoardPair>& pairs, bool is_right, int width_px, int height_px);

/// Sentences on the views that are missing: parts of the images without corners, boards that never lean, one distance.
std::vector<std::string> missing_views(const std::vector<BoardPair>& pairs, const RigSolution& solution);

}  // namespace flies
