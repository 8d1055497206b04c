#pragma once

#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/rig/board_tools.hpp"

namespace flies {

/// A view that was left out, and why.
struct DroppedView {
  std::string name, reason;
};

struct RigReport {
  RigSolution solution;
  std::vector<BoardPair> used;  ///< in the order of `solution.views`
  std::vector<DroppedView> dropped;
  std::vector<std::string> notes;  ///< what to look at, and which views are missing
  Calibration calibration;         ///< the rig as files have it
};

/// Two cameras from the boards that they saw: drops blurred views and those that fit no rig.
/// @param pairs views in which both images show the board
/// @throws InputError when no rig can be told from them: too few views, too large errors, a focal length that the views
///         do not tell, left and right swapped, a baseline that cannot be
RigReport calibrate_rig(const BoardTools& tools, const Board& board, std::vector<BoardPair> pairs, int width_px,
                        int height_px, Lens lens);

}  // namespace flies
