#pragma once

#include <cstdint>
#include <span>

#include "flies/core/field.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/evolve/evolve_options.hpp"
#include "flies/fitness/fitness.hpp"

namespace flies {

/// Which random numbers an evolution draws. Equal values give equal populations.
struct RandomSource {
  std::uint64_t seed = 1;
  std::uint32_t frame = 0;  ///< index of the pair, so that each pair of a sequence gets its own flies
};

struct EvolveResult {
  Population flies;             ///< scored, `EvolveOptions::flies` of them
  std::size_t evaluations = 0;  ///< fitness evaluations spent
};

/// Spreads flies over the field of detection and lets them evolve towards visible surfaces (METHOD section
/// "Evolution"). With 0 generations the flies are only spread and scored.
/// @param steer_towards obstacles of the previous pair, may be empty; see `EvolveOptions::steering_share`
EvolveResult evolve(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road,
                    const FieldOptions& field, const FitnessOptions& fitness, const EvolveOptions& options,
                    const RandomSource& random, std::span<const Obstacle> steer_towards = {});

/// @throws InputError naming `source` when the shares of the children add up to more than 1
void check_evolve_options(const EvolveOptions& options, const std::string& source);

}  // namespace flies
