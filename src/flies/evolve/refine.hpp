#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/evolve/evolve_options.hpp"
#include "flies/fitness/fitness.hpp"

namespace flies {

/// Memory of `refine`: neighbours in disparity of some flies, and their fitness.
struct RefineTrials {
  ImagePopulation before, after;
};

/// The memetic step: moves flies along their line of sight to the vertex of the parabola through their own fitness and
/// that of two neighbours in disparity, or to the fitter neighbour where it has none. Their fitness becomes that of the
/// parabola there.
/// @param chosen indices of the flies; those without fitness are left as they are
/// @returns the number of evaluations, two for each of the chosen
/// Runs on oneTBB's current arena; results do not depend on the number of threads.
std::size_t refine(const RectifiedPair& pair, const FitnessOptions& fitness, double step_px,
                   std::span<const std::uint32_t> chosen, RefineTrials& trials, ImagePopulation& flies);

}  // namespace flies
