#include "flies/evolve/evolve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flies/core/error.hpp"
#include "flies/core/usable_pair.hpp"
#include "flies/evolve/habitat.hpp"
#include "flies/evolve/operators.hpp"
#include "flies/evolve/score_part.hpp"

namespace flies {
namespace {

/// Keeps the streams of the first flies, of the children and of the scouts of both apart; the frame counts above it.
constexpr std::uint32_t kFirstGeneration = 0;
constexpr std::uint32_t kChildren = 1;
constexpr std::uint32_t kScouts = 2;  ///< added to those
constexpr std::uint32_t kPurposes = 4;

std::size_t part_of(double share, std::size_t count) {
  return static_cast<std::size_t>(std::lround(share * static_cast<double>(count)));
}

/// What making any new fly needs.
struct Scene {
  const Habitat& habitat;
  const EvolveOptions& options;
  std::span<const Obstacle> steer_towards;
};

/// Which of `count` new flies are of which kind, in this order: steered, crossed, drawn anew, and mutated the rest.
/// Counts instead of lots: the shares are exact and flies of one kind are made in a row.
struct OffspringKinds {
  std::size_t steered_end = 0, crossed_end = 0, spawned_end = 0;
};

OffspringKinds first_offspring(const Scene& scene, std::size_t count) {
  const auto steered = scene.steer_towards.empty() ? 0 : part_of(scene.options.steering_share, count);
  return {steered, steered, count};
}

OffspringKinds later_offspring(const Scene& scene, std::size_t parents, std::size_t children) {
  if (parents == 0) return first_offspring(scene, children);
  const auto& options = scene.options;
  const double steering_share = scene.steer_towards.empty() ? 0.0 : options.steering_share;
  const double crossed_share = steering_share + options.crossover_share;
  return {part_of(steering_share, children), part_of(crossed_share, children),
          part_of(crossed_share + options.immigration_share, children)};
}

/// Where the draws of new flies come from.
struct RandomStream {
  const RandomSource& source;
  std::uint32_t purpose, generation;

  FlyRange range(std::size_t first, std::size_t count) const {
    return {source.seed, source.frame * kPurposes + purpose, generation, static_cast<std::uint32_t>(first), count};
  }
  RandomStream scouts() const { return {source, purpose + kScouts, generation}; }
  FlyDraws draws(std::size_t fly) const {
    const auto all = range(fly, 1);
    return {all.seed, all.purpose, all.generation, all.first};
  }
};

/// Makes the new flies [begin, end), part of offspring that follow `parents` survivors.
void make_offspring(const Scene& scene, const OffspringKinds& kinds, std::size_t parents, double mutation_scale,
                    const RandomStream& stream, std::size_t begin, std::size_t end, ImagePopulation& flies) {
  const auto& [habitat, options, steer_towards] = scene;
  std::size_t i = begin;
  const auto any_parent = [&](std::uint32_t word) {
    return flies.point(below(word, static_cast<std::uint32_t>(parents)));
  };
  for (; i < std::min(end, parents + kinds.steered_end); ++i) {
    auto draws = stream.draws(i);
    flies.set(i, steer(habitat, steer_towards, draws));
  }
  for (; i < std::min(end, parents + kinds.crossed_end); ++i) {
    const auto words = stream.draws(i).next();
    flies.set(i, cross(habitat, any_parent(words[0]), any_parent(words[1]), uniform(words[2])));
  }
  if (const auto spawned_end = std::min(end, parents + kinds.spawned_end); i < spawned_end) {
    spawn(habitat, options, stream.range(i, spawned_end - i), i, flies);
    scout(habitat, options.scouts, stream.scouts().range(i, spawned_end - i), i, flies);
    i = spawned_end;
  }
  for (; i < end; ++i) {
    auto draws = stream.draws(i);
    const auto parent = any_parent(draws.next()[0]);
    flies.set(i, mutate(habitat, options.mutation, mutation_scale, parent, draws));
  }
}

/// Moves the chosen flies to the front.
void keep(std::span<const std::uint32_t> chosen, ImagePopulation& flies) {
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const auto i = chosen[k];  // ascending, hence not below k
    flies.set(k, flies.point(i), flies.fitness[i]);
  }
}

/// Whether the point is finite, in single precision too.
bool is_single(const Point3& point) {
  const auto fits = [](double value) { return std::isfinite(static_cast<float>(value)); };
  return fits(point.x_m) && fits(point.y_m) && fits(point.z_m);
}

void locate(const Habitat& habitat, const ImagePopulation& in_image, Population& flies) {
  flies.resize(in_image.size());
  const Point3 camera{0.0, 0.0, habitat.projection().height_m()};
  for_parts(0, in_image.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Point3 point = habitat.point(in_image.point(i));
      // So far away that a float cannot tell its disparity from infinity: it is nowhere, and counts for nothing.
      if (is_single(point)) {
        flies.set(i, point, in_image.fitness[i]);
      } else {
        flies.set(i, camera);
      }
    }
  });
}

}  // namespace

void check_evolve_options(const EvolveOptions& options, const std::string& source) {
  check_options(options, source);
  const double shares = options.crossover_share + options.immigration_share + options.steering_share;
  if (shares > 1.0)
    throw InputError(
        source, "evolve.crossover_share",
        fmt::format("crossover, immigration and steering shares add up to {:.3g}, expected at most 1", shares));
}

const EvolveResult& Evolver::evolve(const RectifiedPair& given, const Projection& projection, const RoadPlane& road,
                                    const FieldOptions& field, const FitnessOptions& fitness,
                                    const EvolveOptions& options, const RandomSource& random,
                                    std::span<const Obstacle> steer_towards) {
  const RectifiedPair pair = detail::usable_pair(given);
  check_field(field, "field options");
  check_options(fitness, "fitness options");
  check_evolve_options(options, "evolve options");
  const Habitat habitat(projection, pair, road, field);
  const Scene scene{habitat, options, steer_towards};
  const int width_px = pair.left.width_px, height_px = pair.left.height_px;
  ImagePopulation& flies = result_.in_image;
  flies.resize(static_cast<std::size_t>(options.flies));
  result_.evaluations = 0;

  const auto make_all = [&](const OffspringKinds& kinds, std::size_t parents, const RandomStream& stream,
                            double mutation_scale) {
    for_parts(parents, flies.size(), [&](std::size_t begin, std::size_t end) {
      make_offspring(scene, kinds, parents, mutation_scale, stream, begin, end, flies);
      score_part(pair, fitness, begin, end, flies);
    });
    result_.evaluations += flies.size() - parents;
  };
  const auto silence_rivalled = [&] {
    if (!options.uniqueness.enforce) return;
    find_rivalled(flies, width_px, height_px, options.uniqueness, uniqueness_grid_, rivalled_);
    for (std::size_t i = 0; i < flies.size(); ++i)
      if (rivalled_[i] != 0) flies.fitness[i] = 0.0F;
  };

  make_all(first_offspring(scene, flies.size()), 0, {random, kFirstGeneration, 0}, 1.0);
  silence_rivalled();
  double mutation_scale = 1.0;
  for (int generation = 1; generation <= options.generations; ++generation) {
    find_crowding(flies, width_px, height_px, options.sharing.cell_px, crowding_grid_, crowding_);
    share_fitness(flies.fitness, crowding_, options.sharing.strength, shared_);
    select_fittest(shared_, part_of(options.keep_share, flies.size()), fittest_);
    keep(fittest_, flies);
    make_all(later_offspring(scene, fittest_.size(), flies.size() - fittest_.size()), fittest_.size(),
             {random, kChildren, static_cast<std::uint32_t>(generation)}, mutation_scale);
    silence_rivalled();
    mutation_scale *= options.mutation.cooling;
  }
  select_fittest(flies.fitness, part_of(options.refine.share, flies.size()), fittest_);
  result_.evaluations += refine(pair, fitness, options.refine.step_px, fittest_, trials_, flies);
  silence_rivalled();
  locate(habitat, flies, result_.flies);
  return result_;
}

EvolveResult evolve(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road,
                    const FieldOptions& field, const FitnessOptions& fitness, const EvolveOptions& options,
                    const RandomSource& random, std::span<const Obstacle> steer_towards) {
  Evolver evolver;
  return evolver.evolve(pair, projection, road, field, fitness, options, random, steer_towards);
}

}  // namespace flies
