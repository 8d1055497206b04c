#pragma once

#include "flies/fitness/fitness.hpp"

namespace flies {

/// The fitness functions written in double precision straight from their definitions, pixel by pixel and without
/// regard for speed: the yardstick for the kernel behind `score_point`. Same arguments, same meaning.
double reference_fitness(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point);

}  // namespace flies
