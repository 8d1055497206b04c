#pragma once

#include <string>
#include <vector>

#include "flies/rig/board_tools.hpp"

namespace flies {

/// Sentences on what may be wrong with a solution.
/// @param tools solve once more where both images fit alone but not together, to see whether one was turned
/// @throws InputError when it is no rig that ranges can be told by, saying the likeliest cause
std::vector<std::string> check_solution(const BoardTools& tools, const Board& board,
                                        const std::vector<BoardPair>& pairs, const RigSolution& solution);

}  // namespace flies
