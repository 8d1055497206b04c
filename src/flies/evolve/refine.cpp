#include "flies/evolve/refine.hpp"

#include <algorithm>

#include "flies/core/parabola.hpp"
#include "flies/evolve/score_part.hpp"

namespace flies {
namespace {

/// Moves a fly to where the parabola through its fitness and that of its neighbours peaks, or to the fitter neighbour
/// where it has no peak.
void climb(float before, float after, double step_px, float& disparity_px, float& fitness) {
  const double slope = 0.5 * (after - before), curvature = 0.5 * (after + before) - fitness;
  const auto parabola = [&](double steps) { return fitness + steps * (slope + steps * curvature); };
  double steps = parabola_vertex(before, fitness, after);
  if (parabola(steps) < std::max(before, after)) steps = after > before ? 1.0 : -1.0;
  disparity_px += static_cast<float>(step_px * steps);
  fitness = static_cast<float>(parabola(steps));
}

}  // namespace

std::size_t refine(const RectifiedPair& pair, const FitnessOptions& fitness, double step_px,
                   std::span<const std::uint32_t> chosen, RefineTrials& trials, ImagePopulation& flies) {
  trials.before.resize(chosen.size());
  trials.after.resize(chosen.size());
  for_parts(0, chosen.size(), [&](std::size_t begin, std::size_t end) {
    const auto try_at = [&](ImagePopulation& trial, double offset_px) {
      for (std::size_t k = begin; k < end; ++k) {
        auto point = flies.point(chosen[k]);
        point.disparity_px += offset_px;
        trial.set(k, point);
      }
      score_part(pair, fitness, begin, end, trial);
    };
    try_at(trials.before, -step_px);
    try_at(trials.after, step_px);
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = chosen[k];
      if (flies.fitness[i] > 0.0F)
        climb(trials.before.fitness[k], trials.after.fitness[k], step_px, flies.disparity_px[i], flies.fitness[i]);
    }
  });
  return 2 * chosen.size();
}

}  // namespace flies
