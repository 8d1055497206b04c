#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "flies/concentrate/concentrate_options.hpp"
#include "flies/concentrate/concentrate_result.hpp"
#include "flies/concentrate/object_parts.hpp"
#include "flies/concentrate/pixel_grid.hpp"
#include "flies/concentrate/sightings.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// Step 6, ours: gives each kept candidate its flies, measures position and size from them, and joins candidates that
/// are parts of one object. Keeps memory from call to call.
class Assembler {
 public:
  void reserve(std::size_t flies, std::size_t candidates);

  /// @param grid       filled with the sightings, dropped to the ground
  /// @param population the number of flies, sighted or not
  /// @param obstacles, obstacle_of_fly are filled, see ConcentrateResult
  void assemble(std::span<const Candidate> candidates, const Sightings& flies, const PixelGrid& grid,
                std::size_t population, const Projection& projection, const RoadPlane& road,
                const ConcentrateOptions& options, std::vector<Obstacle>& obstacles, std::vector<int>& obstacle_of_fly);

 private:
  /// Notes the kept candidates, from left to right in the image.
  void choose_candidates(std::span<const Candidate> candidates);

  /// Gives every fly in the grid to the nearest of them within reach.
  void divide_flies(std::size_t flies, const PixelGrid& grid, double reach_px);

  std::vector<Candidate> kept_;
  std::vector<double> nearest_px2_;             ///< of each place in the grid: distance from the nearest candidate
  std::vector<std::uint32_t> nearest_, owner_;  ///< that candidate, or kNone: of each place and of each fly
  ObjectParts parts_;
  std::vector<std::pair<Obstacle, const Part*>> found_;
};

}  // namespace flies
