#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "flies/core/fly.hpp"
#include "flies/core/random.hpp"
#include "flies/core/results.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/evolve/evolve_options.hpp"
#include "flies/evolve/habitat.hpp"

/// The genetic operators that make one fly (Li 2010, II.A; Louchet 2001), each on its own. Flies are image coordinates;
/// the draws handed in are the only source of chance.
namespace flies {

/// Largest difference of grey levels along the row through a point of the left image, in the patch-wide window nearest
/// to the point. Places without horizontal variation cannot be matched, however the fitness is defined. 0 outside the
/// image.
int row_contrast(const GrayView& left, const StereoPoint& point);

/// A random fly of the habitat, for the first generation and for immigration, at a place of at least
/// `EvolveOptions::informative_gray` row contrast. After a bounded number of draws the last one is returned as it is.
StereoPoint spawn(const Habitat& habitat, const EvolveOptions& options, FlyDraws draws);

/// Whose draws: flies count up from `first`.
struct FlyRange {
  std::uint64_t seed = 0;
  std::uint32_t purpose = 0, generation = 0, first = 0;
  std::size_t count = 0;
};

/// `spawn` of many flies into [begin, begin + count) of `flies`, in single precision and vectors where it can be.
void spawn(const Habitat& habitat, const EvolveOptions& options, const FlyRange& range, std::size_t begin,
           ImagePopulation& flies);

/// Scouting: of `scouts` places on the fly's line of sight, the one whose row of pixels correlates best in both images.
/// The disparities that the habitat holds there are divided into steps of equal ratio, and each has its place at the
/// same random share of its step. A row costs a small part of what a fitness does.
/// @returns the fly itself when its row leaves the left image or the habitat holds no disparity
/// @throws InputError when `scouts` is not 0 to `kernels::kMaxScouts`
StereoPoint scout(const Habitat& habitat, int scouts, const StereoPoint& fly, FlyDraws draws);

/// `scout` for the flies [begin, begin + range.count), in single precision and vectors.
void scout(const Habitat& habitat, int scouts, const FlyRange& range, std::size_t begin, ImagePopulation& flies);

/// Mutation: the parent moved by normal deviates in the left image and in disparity, `scale` times the options'.
/// A child outside the habitat is drawn again a few times, then the parent is returned.
StereoPoint mutate(const Habitat& habitat, const MutationOptions& options, double scale, const StereoPoint& parent,
                   FlyDraws& draws);

/// Crossover: the point at `share` (0 to 1) of the way from mother to father in the vehicle frame.
StereoPoint cross(const Habitat& habitat, const StereoPoint& mother, const StereoPoint& father, double share);

/// Re-generation steered by the concentrating step: a random point on one of the obstacles found last, normally
/// distributed around its near face. `obstacles` must not be empty.
StereoPoint steer(const Habitat& habitat, std::span<const Obstacle> obstacles, FlyDraws& draws);

}  // namespace flies
