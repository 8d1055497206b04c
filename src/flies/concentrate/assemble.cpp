#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "flies/concentrate/concentrate.hpp"
#include "flies/concentrate/object_parts.hpp"

namespace flies {
namespace {

/// Gives every fly to the nearest kept candidate within reach. @returns the candidates that got any
std::vector<Part> divide_flies(const std::vector<Candidate>& candidates, const std::vector<DroppedFly>& dropped,
                               std::span<const Echo> echoes, const ConcentrateOptions& options) {
  std::vector<Candidate> kept;
  for (const auto& candidate : candidates)
    if (candidate.kept) kept.push_back(candidate);
  // Sorted by column, those within reach of a fly follow each other.
  std::stable_sort(kept.begin(), kept.end(),
                   [](const Candidate& a, const Candidate& b) { return a.pixel.u_px < b.pixel.u_px; });
  const double reach_px = options.assemble.radius_bandwidths * options.bandwidth_px;
  std::vector<std::vector<std::size_t>> members(kept.size());
  for (std::size_t i = 0; i < dropped.size(); ++i) {
    const auto& [pixel, fitness] = dropped[i];
    if (!(fitness > 0.0)) continue;
    double nearest_px2 = reach_px * reach_px;
    std::optional<std::size_t> owner;
    auto candidate = std::lower_bound(kept.begin(), kept.end(), pixel.u_px - reach_px,
                                      [](const Candidate& c, double u_px) { return c.pixel.u_px < u_px; });
    for (; candidate != kept.end() && candidate->pixel.u_px <= pixel.u_px + reach_px; ++candidate) {
      const double du = pixel.u_px - candidate->pixel.u_px, dv = pixel.v_px - candidate->pixel.v_px;
      if (du * du + dv * dv > nearest_px2) continue;
      nearest_px2 = du * du + dv * dv;
      owner = static_cast<std::size_t>(candidate - kept.begin());
    }
    if (owner) members[*owner].push_back(i);
  }
  std::vector<Part> parts;
  for (std::size_t k = 0; k < kept.size(); ++k)
    if (!members[k].empty()) parts.push_back(make_part(std::move(members[k]), kept[k], echoes, options.assemble));
  return parts;
}

double score(const Part& part, std::size_t population) { return part.fitness / static_cast<double>(population); }

/// Tall enough to be more than a marking or a kerb. A fly some way above a marking still has it in its neighbourhood,
/// so the least height grows with what a neighbourhood covers at that range.
bool rises_from_road(const Part& part, const Projection& projection, const AssembleOptions& options) {
  return part.extent.top_m >= options.min_height_m + options.min_height_px * part.extent.near_m / projection.fy_px();
}

/// Big enough, and seen by enough flies, to be more than a false match.
bool is_supported(const Part& part, std::size_t population, const AssembleOptions& options) {
  const double covered_m = std::max(part.extent.width_m(), part.extent.top_m - part.extent.bottom_m);
  return score(part, population) >= options.min_score && static_cast<int>(part.members.size()) >= options.min_flies &&
         covered_m >= options.min_extent_m;
}

/// The box from the road to the top, at the near face.
ImageBox project_box(const Extent& extent, const Projection& projection, const RoadPlane& road) {
  const auto corner = [&](double azimuth_rad, double height_m) {
    const double x = extent.near_m * std::cos(azimuth_rad), y = extent.near_m * std::sin(azimuth_rad);
    return projection.project({x, y, road.z_m(x, y) + height_m});
  };
  const auto top_left = corner(extent.left_rad, extent.top_m), bottom_right = corner(extent.right_rad, 0.0);
  return {top_left.u_px, top_left.v_px, bottom_right.u_px - top_left.u_px, bottom_right.v_px - top_left.v_px};
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
  obstacle.box = project_box(part.extent, projection, road);
  return obstacle;
}

}  // namespace

Assembly assemble_obstacles(const std::vector<Candidate>& candidates, const Population& flies,
                            const std::vector<DroppedFly>& dropped, const Projection& projection, const RoadPlane& road,
                            const ConcentrateOptions& options) {
  const auto echoes = measure_echoes(flies, road);
  auto parts = divide_flies(candidates, dropped, echoes, options);
  std::erase_if(parts, [&](const Part& part) { return !rises_from_road(part, projection, options.assemble); });
  if (options.assemble.merge) parts = join_parts(std::move(parts), echoes, options.assemble);
  std::erase_if(parts, [&](const Part& part) { return !is_supported(part, flies.size(), options.assemble); });

  Assembly result{{}, std::vector<int>(flies.size(), -1)};
  std::vector<std::pair<Obstacle, const Part*>> found;
  for (const auto& part : parts)
    found.emplace_back(make_obstacle(part, flies.size(), projection, road, options.assemble), &part);
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first.range_m < b.first.range_m; });
  for (const auto& [obstacle, part] : found) {
    for (const auto i : part->members) result.obstacle_of_fly[i] = static_cast<int>(result.obstacles.size());
    result.obstacles.push_back(obstacle);
  }
  return result;
}

}  // namespace flies
