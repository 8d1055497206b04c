#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "flies/rig/board_tools.hpp"

namespace flies {

/// Both images side by side, without what they show: every corner that was used, coloured by how far it lies from where
/// the solution sees it (green below 0.5 px, yellow below 1 px, red), ninths without corners hatched.
cv::Mat draw_coverage(const std::vector<BoardPair>& pairs, const RigSolution& solution);

}  // namespace flies
