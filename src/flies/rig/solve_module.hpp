#pragma once

#include "flies/rig/board_tools.hpp"

namespace flies {

/// See BoardTools::solve.
RigSolution solve_rig(const std::vector<BoardPair>& pairs, const Board& board, int width_px, int height_px, Lens lens);

}  // namespace flies
