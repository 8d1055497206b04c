#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flies/core/field.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/random.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/evolve/evolve_options.hpp"

/// The genetic operators (METHOD section "Evolution"), each on its own. Points are in the vehicle frame; the random
/// stream handed in is the only source of chance.
namespace flies {

/// What the operators need to know of the scene: where flies may live.
struct Habitat {
  Projection projection;
  GrayView left;  ///< the left image
  RoadPlane road;
  FieldOptions field;
};

/// True when the point lies in the field of detection and falls into the left image.
bool in_habitat(const Habitat& habitat, const Point3& point);

/// Largest difference of grey levels along the row through a point of the left image, a patch wide. Places without
/// horizontal variation cannot be matched, however the fitness is defined. 0 outside the image.
int row_contrast(const GrayView& left, const StereoPoint& point);

/// A random point of the habitat, for the first generation and for immigration, that projects to a place of at least
/// `informative_gray` row contrast. After a bounded number of draws the last one is returned as it is.
Point3 spawn(const Habitat& habitat, InitialDistribution distribution, double informative_gray, FlyRandom& random);

/// Crowding: how many flies share the image cell of each fly. Every fly counts 2 in its own cell and 1 in the four
/// next to it (Louchet); the result is that count over 2, at least 1 for every fly that falls into the image.
std::vector<float> crowding(const Habitat& habitat, const Population& flies, int cell_px);

/// Sharing: fitness divided by crowding to the power of `strength`.
std::vector<float> share_fitness(std::span<const float> fitness, std::span<const float> crowding, double strength);

/// Uniqueness: a pixel shows one surface. For every fly, whether a fitter fly of clearly other disparity looks at
/// nearly the same place of the left or of the right image; then at most the fitter one can be right.
std::vector<bool> find_rivalled(const Habitat& habitat, const Population& flies, const UniquenessOptions& options);

/// Selection: the indices of the `count` largest values, ascending. Equal values: the lower index wins.
std::vector<std::uint32_t> select_fittest(std::span<const float> shared_fitness, std::size_t count);

/// Mutation: the parent moved by normal deviates in the left image and in disparity, `scale` times the options'.
/// A child outside the habitat is drawn again a few times, then the parent is returned.
Point3 mutate(const Habitat& habitat, const MutationOptions& options, double scale, const Point3& parent,
              FlyRandom& random);

/// Crossover: a random point on the segment between the parents.
Point3 cross(const Point3& mother, const Point3& father, FlyRandom& random);

/// Re-generation steered by the concentrating step: a random point on one of the obstacles found last, normally
/// distributed around its near face. `obstacles` must not be empty.
Point3 steer(const Habitat& habitat, std::span<const Obstacle> obstacles, FlyRandom& random);

}  // namespace flies
