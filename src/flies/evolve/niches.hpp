#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/core/fly.hpp"
#include "flies/evolve/evolve_options.hpp"
#include "flies/evolve/kernels/rivals.hpp"

/// The operators that look at the whole population (Li 2010, II.A; Louchet 2001): sharing, uniqueness, selection. Each
/// writes into vectors of its caller, which keep their memory from call to call.
namespace flies {

/// Memory of `find_crowding`. The counts are 0 between calls.
struct CrowdingGrid {
  std::vector<std::uint32_t> counts;
  std::vector<std::uint32_t> cell_of_fly;
};

/// Crowding: how many flies share the image cell of each fly. Every fly counts 2 in its own cell and 1 in the four
/// next to it (Louchet); the result is that count over 2, at least 1, and 1 for a fly outside the image.
/// @param crowding of each fly, set to the size of the population
void find_crowding(const ImagePopulation& flies, int width_px, int height_px, int cell_px, CrowdingGrid& grid,
                   std::vector<float>& crowding);

/// Sharing: divides the crowding out of the fitness, to the power of `strength`.
/// @param shared set to the size of the population
void share_fitness(std::span<const float> fitness, std::span<const float> crowding, double strength,
                   std::vector<float>& shared);

/// Memory of `find_rivalled`. The cells have no fitness between calls.
struct UniquenessGrid {
  struct OfSearch {
    std::vector<kernels::Look> fittest;  ///< of each cell
    std::vector<kernels::Look> looks;
    std::vector<std::uint32_t> cell_of_fly, listed;
    std::vector<std::uint8_t> rivalled;
  };
  std::array<OfSearch, 2> searches;  ///< the second only while the first is in use
};

/// Uniqueness: a pixel shows one surface. For every fly, whether a fitter fly of clearly other disparity looks at
/// nearly the same place of the left or of the right image; then at most the fitter one can be right.
/// @param rivalled set to the size of the population: 1 for rivalled, 0 for not
/// Searches both images at once on oneTBB's current arena.
void find_rivalled(const ImagePopulation& flies, int width_px, int height_px, const UniquenessOptions& options,
                   UniquenessGrid& grid, std::vector<std::uint8_t>& rivalled);

/// Selection: the indices of the `count` largest values, ascending. Equal values: the lower index wins.
/// @param fitness >= 0
/// @param fittest set to at most `count` indices
void select_fittest(std::span<const float> fitness, std::size_t count, std::vector<std::uint32_t>& fittest);

}  // namespace flies
