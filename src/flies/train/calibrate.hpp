#pragma once

#include <span>

#include "flies/classify/people_model.hpp"

namespace flies {

/// Fits Platt's sigmoid to scores of windows that were not learnt from, by Newton's method with backtracking and with
/// Platt's softened targets (Lin, Lin, Weng, "A note on Platt's probabilistic outputs for support vector machines",
/// 2007), which keeps few or separable windows from giving certainties.
/// @param people     scores of windows with a person, finite
/// @param background scores of windows without, finite
/// @returns a rising sigmoid; `ScoreCalibration{}` when one of the lists is empty or people do not score higher
ScoreCalibration fit_calibration(std::span<const double> people, std::span<const double> background);

}  // namespace flies
