#pragma once

#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"

namespace flies {

/// In what the images of two cameras differ that should see alike. Ratios are those of the right image over the left.
struct SideDifference {
  /// Of the cells of a grid of 20 x 8 that show something, those whose place in the other image shows nothing: 0.04 at
  /// most in 53 good pairs.
  double left_blind_share = 0.0, right_blind_share = 0.0;
  double sharpness = 1.0;  ///< of gradients over contrast; 0.84 to 1.14 in good pairs
  double contrast = 1.0;   ///< of the standard deviations of the grey levels; 0.89 to 1.07 in good pairs
};

/// @param pair both images of one size, at least 64 x 48 px
SideDifference compare_sides(const RectifiedPair& pair);

/// Member by member the median. @returns no difference for no pairs
SideDifference median_side_difference(const std::vector<SideDifference>& pairs);

/// What is wrong with one of the cameras, one sentence each; empty when both see alike.
std::vector<std::string> complaints(const SideDifference& difference);

}  // namespace flies
