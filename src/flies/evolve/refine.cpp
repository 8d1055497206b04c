#include "flies/evolve/refine.hpp"

#include "flies/core/parabola.hpp"
#include "flies/evolve/score_part.hpp"

namespace flies {
namespace {

void move_if_fitter(const ImagePopulation& trials, std::size_t k, std::size_t i, ImagePopulation& flies) {
  if (!(trials.fitness[k] > flies.fitness[i])) return;
  flies.disparity_px[i] = trials.disparity_px[k];
  flies.fitness[i] = trials.fitness[k];
}

}  // namespace

std::size_t refine(const RectifiedPair& pair, const FitnessOptions& fitness, double step_px,
                   std::span<const std::uint32_t> chosen, RefineTrials& trials, ImagePopulation& flies) {
  for (auto* trial : {&trials.before, &trials.after, &trials.vertex}) trial->resize(chosen.size());
  for_parts(0, chosen.size(), [&](std::size_t begin, std::size_t end) {
    const auto try_at = [&](ImagePopulation& trial, const auto& offset_px) {
      for (std::size_t k = begin; k < end; ++k) {
        auto point = flies.point(chosen[k]);
        point.disparity_px += offset_px(k);
        trial.set(k, point);
      }
      score_part(pair, fitness, begin, end, trial);
    };
    try_at(trials.before, [&](std::size_t) { return -step_px; });
    try_at(trials.after, [&](std::size_t) { return step_px; });
    try_at(trials.vertex, [&](std::size_t k) {
      return step_px * parabola_vertex(trials.before.fitness[k], flies.fitness[chosen[k]], trials.after.fitness[k]);
    });
    for (std::size_t k = begin; k < end; ++k) {
      if (!(flies.fitness[chosen[k]] > 0.0F)) continue;
      for (const auto* trial : {&trials.before, &trials.after, &trials.vertex})
        move_if_fitter(*trial, k, chosen[k], flies);
    }
  });
  return 3 * chosen.size();
}

}  // namespace flies
