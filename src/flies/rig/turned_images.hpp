#pragma once

#include <string>
#include <vector>

#include "flies/rig/board_tools.hpp"

namespace flies {

/// Of pairs that fit no rig: whether they do with the images of one camera turned by 180 degrees or mirrored, in words.
/// A chessboard does not tell by itself, as it is read the same way from either end. Empty when none of these fits.
/// @param solution of the pairs as they are
std::string turned_images(const BoardTools& tools, const Board& board, const std::vector<BoardPair>& pairs,
                          const RigSolution& solution);

}  // namespace flies
