#include "flies/evolve/evolve.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/parabola.hpp"
#include "flies/evolve/operators.hpp"

namespace flies {
namespace {

constexpr std::size_t kFliesPerTask = 512;

/// Keeps the streams of the first flies and of the children apart; the frame counts above it.
constexpr std::uint32_t kFirstGeneration = 0;
constexpr std::uint32_t kChildren = 1;
constexpr std::uint32_t kPurposes = 2;

FlyRandom stream(const RandomSource& source, std::uint32_t purpose, std::uint32_t generation, std::size_t fly) {
  return {source.seed, source.frame * kPurposes + purpose, generation, static_cast<std::uint32_t>(fly)};
}

template <class MakePoint>
void fill(Population& flies, std::size_t begin, const MakePoint& make_point) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, flies.size(), kFliesPerTask), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) flies.set(i, make_point(i));
  });
}

Population first_generation(const Habitat& habitat, const EvolveOptions& options, const RandomSource& source,
                            std::span<const Obstacle> steer_towards) {
  Population flies;
  flies.resize(static_cast<std::size_t>(options.flies));
  fill(flies, 0, [&](std::size_t i) {
    auto random = stream(source, kFirstGeneration, 0, i);
    const bool steered = !steer_towards.empty() && random.uniform() < options.steering_share;
    return steered ? steer(habitat, steer_towards, random)
                   : spawn(habitat, options.initial, options.informative_gray, random);
  });
  return flies;
}

/// One child: of which kind is a draw from the shares of the options; what is left over is mutation.
Point3 breed(const Habitat& habitat, const EvolveOptions& options, double mutation_scale, const Population& parents,
             std::size_t parent_count, std::span<const Obstacle> steer_towards, FlyRandom& random) {
  const auto any_parent = [&] { return parents.point(random.below(static_cast<std::uint32_t>(parent_count))); };
  double lot = random.uniform();
  if (parent_count == 0 || (lot -= options.immigration_share) < 0.0)
    return spawn(habitat, options.initial, options.informative_gray, random);
  if (!steer_towards.empty() && (lot -= options.steering_share) < 0.0) return steer(habitat, steer_towards, random);
  if ((lot -= options.crossover_share) < 0.0) return cross(any_parent(), any_parent(), random);
  return mutate(habitat, options.mutation, mutation_scale, any_parent(), random);
}

void silence_rivalled(const Habitat& habitat, const UniquenessOptions& options, Population& flies) {
  if (!options.enforce) return;
  const auto rivalled = find_rivalled(habitat, flies, options);
  for (std::size_t i = 0; i < flies.size(); ++i)
    if (rivalled[i]) flies.fitness[i] = 0.0F;
}

/// The memetic step: moves one fly along its line of sight to the vertex of the parabola through its own fitness and
/// that of two neighbours in disparity, or to the fitter neighbour, or leaves it. Three evaluations.
Fly refine(const RectifiedPair& pair, const Projection& projection, const FitnessOptions& fitness, double step_px,
           const Fly& fly) {
  const auto at = projection.project(fly.point);
  const auto score = [&](double offset_px) {
    return score_point(pair, fitness, {at.u_px, at.v_px, at.disparity_px + offset_px});
  };
  const float before = score(-step_px), after = score(step_px);
  const double vertex_px = step_px * parabola_vertex(before, fly.fitness, after);
  const std::array<std::pair<float, double>, 4> choices = {
      {{fly.fitness, 0.0}, {before, -step_px}, {after, step_px}, {score(vertex_px), vertex_px}}};
  const auto best =
      std::max_element(choices.begin(), choices.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (best == choices.begin()) return fly;
  return {projection.triangulate({at.u_px, at.v_px, at.disparity_px + best->second}), best->first};
}

/// Refines the fittest flies. @returns the number of evaluations
std::size_t refine_fittest(const RectifiedPair& pair, const Projection& projection, const FitnessOptions& fitness,
                           const RefineOptions& options, Population& flies) {
  constexpr std::size_t kEvaluations = 3;
  const auto count = static_cast<std::size_t>(std::lround(options.share * static_cast<double>(flies.size())));
  const auto fittest = select_fittest(flies.fitness, count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, fittest.size(), kFliesPerTask), [&](const auto& range) {
    for (std::size_t k = range.begin(); k != range.end(); ++k) {
      const auto i = fittest[k];
      if (!(flies.fitness[i] > 0.0F)) continue;
      const auto refined = refine(pair, projection, fitness, options.step_px, flies.fly(i));
      flies.set(i, refined.point, refined.fitness);
    }
  });
  return kEvaluations * fittest.size();
}

Population survivors_first(const Population& flies, std::span<const std::uint32_t> survivors) {
  Population next;
  next.resize(flies.size());
  for (std::size_t i = 0; i < survivors.size(); ++i)
    next.set(i, flies.point(survivors[i]), flies.fitness[survivors[i]]);
  return next;
}

}  // namespace

void check_evolve_options(const EvolveOptions& options, const std::string& source) {
  const double shares = options.crossover_share + options.immigration_share + options.steering_share;
  if (shares > 1.0)
    throw InputError(
        source, "evolve.crossover_share",
        fmt::format("crossover, immigration and steering shares add up to {:.3g}, expected at most 1", shares));
}

EvolveResult evolve(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road,
                    const FieldOptions& field, const FitnessOptions& fitness, const EvolveOptions& options,
                    const RandomSource& random, std::span<const Obstacle> steer_towards) {
  const Habitat habitat{projection, pair.left, road, field};
  EvolveResult result{first_generation(habitat, options, random, steer_towards), 0};
  auto& flies = result.flies;
  score_flies(pair, projection, fitness, flies, 0, flies.fitness);
  silence_rivalled(habitat, options.uniqueness, flies);
  result.evaluations = flies.size();

  double mutation_scale = 1.0;
  for (int generation = 1; generation <= options.generations; ++generation) {
    const auto shared =
        share_fitness(flies.fitness, crowding(habitat, flies, options.sharing.cell_px), options.sharing.strength);
    const auto keep = static_cast<std::size_t>(std::lround(options.keep_share * options.flies));
    const auto survivors = select_fittest(shared, keep);
    flies = survivors_first(flies, survivors);
    fill(flies, survivors.size(), [&](std::size_t i) {
      auto child_random = stream(random, kChildren, static_cast<std::uint32_t>(generation), i);
      return breed(habitat, options, mutation_scale, flies, survivors.size(), steer_towards, child_random);
    });
    const auto children = std::span(flies.fitness).subspan(survivors.size());
    score_flies(pair, projection, fitness, flies, survivors.size(), children);
    silence_rivalled(habitat, options.uniqueness, flies);
    result.evaluations += children.size();
    mutation_scale *= options.mutation.cooling;
  }
  result.evaluations += refine_fittest(pair, projection, fitness, options.refine, flies);
  silence_rivalled(habitat, options.uniqueness, flies);
  return result;
}

}  // namespace flies
