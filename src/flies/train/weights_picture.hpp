#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

#include "flies/classify/hog.hpp"

namespace flies {

/// Draws the weights of a linear machine as edges: in every cell a stroke for every orientation, along the edge, the
/// brighter the larger its weight, summed over the blocks that hold the cell. To the left weights for a person, to the
/// right weights against.
/// @param weights `feature_count(geometry)` of them
/// @returns CV_8UC3
cv::Mat draw_weights(std::span<const float> weights, const HogGeometry& geometry);

}  // namespace flies
