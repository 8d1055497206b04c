#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "flies/core/field.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/evolve/evolve_options.hpp"
#include "flies/evolve/niches.hpp"
#include "flies/evolve/refine.hpp"
#include "flies/fitness/fitness.hpp"

namespace flies {

/// Which random numbers an evolution draws. Equal values give equal populations.
struct RandomSource {
  std::uint64_t seed = 1;
  std::uint32_t frame = 0;  ///< index of the pair, so that each pair of a sequence gets its own flies
};

struct EvolveResult {
  Population flies;             ///< scored, `EvolveOptions::flies` of them
  ImagePopulation in_image;     ///< the same flies by their image coordinates
  std::size_t evaluations = 0;  ///< fitness evaluations spent
};

/// Spreads flies over the field of detection and lets them evolve towards visible surfaces (Li 2010, II.A; Louchet
/// 2001). With 0 generations the flies are only spread and scored.
/// @param steer_towards obstacles of the previous pair, may be empty; see `EvolveOptions::steering_share`
/// @throws InputError naming an option out of its range, or an image that is empty or of another size
/// Runs on oneTBB's current arena; results do not depend on the number of threads.
EvolveResult evolve(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road,
                    const FieldOptions& field, const FitnessOptions& fitness, const EvolveOptions& options,
                    const RandomSource& random, std::span<const Obstacle> steer_towards = {});

/// The same for pair after pair. Keeps memory and nothing else from call to call: once it has seen a population of the
/// size and images of the size, it allocates no more. Threads: one object serves one thread at a time.
class Evolver {
 public:
  /// @returns a result that is valid until the next call
  const EvolveResult& evolve(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road,
                             const FieldOptions& field, const FitnessOptions& fitness, const EvolveOptions& options,
                             const RandomSource& random, std::span<const Obstacle> steer_towards = {});

 private:
  EvolveResult result_;
  CrowdingGrid crowding_grid_;
  UniquenessGrid uniqueness_grid_;
  std::vector<float> crowding_, shared_;
  std::vector<std::uint8_t> rivalled_;
  std::vector<std::uint32_t> fittest_;
  RefineTrials trials_;
};

/// @throws InputError naming `source` and an option out of its range, or when the shares of the children add up to more
///         than 1
void check_evolve_options(const EvolveOptions& options, const std::string& source);

}  // namespace flies
