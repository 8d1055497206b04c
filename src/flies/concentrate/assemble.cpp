#include "flies/concentrate/assemble.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "flies/concentrate/board_box.hpp"

namespace flies {
namespace {

double score(const Part& part, std::size_t population) { return part.fitness / static_cast<double>(population); }

/// Tall enough to be more than a marking or a kerb. A fly some way above a marking still has it in its neighbourhood,
/// so the least height grows with what a neighbourhood covers at that range.
bool rises_from_road(const Part& part, const Projection& projection, const AssembleOptions& options) {
  return part.extent.top_m >= options.min_height_m + options.min_height_px * part.extent.near_m / projection.fy_px();
}

/// Big enough, and seen by enough flies, to be more than a false match.
bool is_supported(const Part& part, std::size_t population, const AssembleOptions& options) {
  const double covered_m = std::max(part.extent.width_m(), part.extent.top_m - part.extent.bottom_m);
  return score(part, population) >= options.min_score && static_cast<int>(part.flies) >= options.min_flies &&
         covered_m >= options.min_extent_m;
}

GroundPoint position(const Part& part, ObstaclePosition wanted) {
  if (wanted == ObstaclePosition::candidate) return part.candidate.ground;
  const double azimuth_rad = part.extent.azimuth_rad();
  return {part.extent.near_m * std::cos(azimuth_rad), part.extent.near_m * std::sin(azimuth_rad)};
}

Obstacle make_obstacle(const Part& part, std::size_t population, const Projection& projection, const RoadPlane& road,
                       const AssembleOptions& options) {
  const auto [x_m, y_m] = position(part, options.position);
  Obstacle obstacle;
  obstacle.x_m = x_m;
  obstacle.y_m = y_m;
  obstacle.range_m = std::hypot(x_m, y_m);
  obstacle.width_m = part.extent.width_m();
  obstacle.height_m = part.extent.top_m;
  obstacle.ground_z_m = road.z_m(x_m, y_m);
  obstacle.score = score(part, population);
  const Extent& extent = part.extent;
  obstacle.box = board_box({extent.near_m, extent.right_rad, extent.left_rad, extent.top_m}, projection, road);
  return obstacle;
}

}  // namespace

void Assembler::reserve(std::size_t flies, std::size_t candidates) {
  kept_.reserve(candidates);
  nearest_px2_.reserve(flies);
  nearest_.reserve(flies);
  owner_.reserve(flies);
  parts_.reserve(flies, candidates);
  found_.reserve(candidates);
}

void Assembler::choose_candidates(std::span<const Candidate> candidates) {
  kept_.clear();
  for (const auto& candidate : candidates)
    if (candidate.kept) kept_.push_back(candidate);
  std::sort(kept_.begin(), kept_.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.pixel.u_px, a.pixel.v_px) < std::tie(b.pixel.u_px, b.pixel.v_px);
  });
}

void Assembler::divide_flies(std::size_t flies, const PixelGrid& grid, double reach_px) {
  nearest_px2_.assign(grid.size(), reach_px * reach_px);
  nearest_.assign(grid.size(), kNone);
  for (std::uint32_t k = 0; k < kept_.size(); ++k) {
    const PixelPoint& p = kept_[k].pixel;
    grid.near(p, reach_px).for_each([&](std::size_t place, double u_px, double v_px) {
      const double du = u_px - p.u_px, dv = v_px - p.v_px;
      const double px2 = du * du + dv * dv;
      const bool is_nearest = px2 <= nearest_px2_[place];
      nearest_px2_[place] = is_nearest ? px2 : nearest_px2_[place];
      nearest_[place] = is_nearest ? k : nearest_[place];
    });
  }
  owner_.assign(flies, kNone);
  for (std::size_t place = 0; place < grid.size(); ++place) owner_[grid.index(place)] = nearest_[place];
}

void Assembler::assemble(std::span<const Candidate> candidates, const Sightings& flies, const PixelGrid& grid,
                         std::size_t population, const Projection& projection, const RoadPlane& road,
                         const ConcentrateOptions& options, std::vector<Obstacle>& obstacles,
                         std::vector<int>& obstacle_of_fly) {
  const auto& assembling = options.assemble;
  choose_candidates(candidates);
  divide_flies(flies.size(), grid, assembling.radius_bandwidths * options.bandwidth_px);
  parts_.gather(flies, kept_, owner_, assembling.near_quantile);
  auto& parts = parts_.parts();
  std::erase_if(parts, [&](const Part& part) { return !rises_from_road(part, projection, assembling); });
  if (assembling.merge) parts_.join(assembling);
  std::erase_if(parts, [&](const Part& part) { return !is_supported(part, population, assembling); });

  found_.clear();
  for (const auto& part : parts)
    found_.emplace_back(make_obstacle(part, population, projection, road, assembling), &part);
  std::sort(found_.begin(), found_.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first.range_m, a.second) < std::tie(b.first.range_m, b.second);
  });
  obstacles.clear();
  obstacle_of_fly.assign(population, -1);
  for (const auto& [obstacle, part] : found_) {
    parts_.for_each_fly(*part,
                        [&](std::uint32_t i) { obstacle_of_fly[flies.fly[i]] = static_cast<int>(obstacles.size()); });
    obstacles.push_back(obstacle);
  }
}

}  // namespace flies
