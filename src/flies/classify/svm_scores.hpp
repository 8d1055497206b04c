#pragma once

#include "flies/classify/people_model.hpp"
#include "flies/classify/window_sets.hpp"

namespace flies {

/// The same number as for the features in one piece.
double linear_score(const LinearStage& stage, const FeaturePieces& pieces);

}  // namespace flies
