#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "flies/concentrate/concentrate.hpp"
#include "flies/concentrate/disjoint_sets.hpp"

namespace flies {
namespace {

/// Quantiles that bound an object: a few stray flies at either end do not stretch it.
constexpr double kLowEdge = 0.05, kHighEdge = 0.95;

using Indices = std::vector<std::size_t>;

/// Where an object is seen from the camera, like the echo of a laser scanner: range and azimuth intervals.
struct Extent {
  double near_m = 0.0, far_m = 0.0;  ///< range along the ground
  double right_rad = 0.0, left_rad = 0.0;
  double top_m = 0.0;  ///< above the road

  double width_m() const { return near_m * (left_rad - right_rad); }
};

/// The value below which `quantile` of the total weight lies. `samples` of (value, weight) are sorted in place.
double weighted_quantile(std::vector<std::pair<double, double>>& samples, double quantile) {
  std::sort(samples.begin(), samples.end());
  double total = 0.0;
  for (const auto& [value, weight] : samples) total += weight;
  double passed = 0.0;
  for (const auto& [value, weight] : samples)
    if ((passed += weight) >= quantile * total) return value;
  return samples.back().first;
}

Extent measure(const Indices& members, const Population& flies, const RoadPlane& road, double near_quantile) {
  std::vector<std::pair<double, double>> range_m, azimuth_rad, height_m;
  for (const auto i : members) {
    const double x = flies.x_m[i], y = flies.y_m[i], weight = flies.fitness[i];
    range_m.emplace_back(std::hypot(x, y), weight);
    azimuth_rad.emplace_back(std::atan2(y, x), weight);
    height_m.emplace_back(flies.z_m[i] - road.z_m(x, y), weight);
  }
  return {weighted_quantile(range_m, near_quantile), weighted_quantile(range_m, 1.0 - near_quantile),
          weighted_quantile(azimuth_rad, kLowEdge), weighted_quantile(azimuth_rad, kHighEdge),
          weighted_quantile(height_m, kHighEdge)};
}

double gap(double low_a, double high_a, double low_b, double high_b) {
  return std::max({0.0, low_b - high_a, low_a - high_b});
}

/// How far two parts are apart, as a share of the gaps that are allowed inside an object; nothing when they cannot
/// belong together.
std::optional<double> separation(const Extent& a, const Extent& b, const AssembleOptions& options) {
  const double range_m = std::min(a.near_m, b.near_m);
  const double depth = gap(a.near_m, a.far_m, b.near_m, b.far_m) / (options.depth_gap_share * range_m);
  const double lateral = range_m * gap(a.right_rad, a.left_rad, b.right_rad, b.left_rad) / options.lateral_gap_m;
  const double width_m = range_m * (std::max(a.left_rad, b.left_rad) - std::min(a.right_rad, b.right_rad));
  const double depth_m = std::max(a.far_m, b.far_m) - range_m;
  if (depth > 1.0 || lateral > 1.0 || width_m > options.max_width_m || depth_m > options.max_width_m) return {};
  return std::hypot(depth, lateral);
}

/// Joins parts, closest first, as long as the whole stays within the largest size of an object.
std::vector<Indices> join_parts(std::vector<Indices> parts, const Population& flies, const RoadPlane& road,
                                const AssembleOptions& options) {
  std::vector<Extent> extents;
  for (const auto& part : parts) extents.push_back(measure(part, flies, road, options.near_quantile));
  while (true) {
    std::size_t best_a = 0, best_b = 0;
    std::optional<double> best;
    for (std::size_t a = 0; a < parts.size(); ++a)
      for (std::size_t b = a + 1; b < parts.size(); ++b)
        if (const auto s = separation(extents[a], extents[b], options); s && (!best || *s < *best)) {
          best = s;
          best_a = a;
          best_b = b;
        }
    if (!best) return parts;
    parts[best_a].insert(parts[best_a].end(), parts[best_b].begin(), parts[best_b].end());
    extents[best_a] = measure(parts[best_a], flies, road, options.near_quantile);
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(best_b));
    extents.erase(extents.begin() + static_cast<std::ptrdiff_t>(best_b));
  }
}

/// Gives every fly to the nearest kept candidate within reach. @returns the flies of each kept candidate
std::vector<Indices> divide_flies(const std::vector<Candidate>& candidates, const Population& flies,
                                  const std::vector<DroppedFly>& dropped, const ConcentrateOptions& options) {
  const double reach_px = options.assemble.radius_bandwidths * options.bandwidth_px;
  std::vector<const Candidate*> kept;
  for (const auto& candidate : candidates)
    if (candidate.kept) kept.push_back(&candidate);
  std::vector<Indices> parts(kept.size());
  for (std::size_t i = 0; i < flies.size(); ++i) {
    if (!(dropped[i].fitness > 0.0)) continue;
    double nearest_px = reach_px;
    std::optional<std::size_t> owner;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const double distance_px =
          std::hypot(dropped[i].pixel.u_px - kept[k]->pixel.u_px, dropped[i].pixel.v_px - kept[k]->pixel.v_px);
      if (distance_px > nearest_px) continue;
      nearest_px = distance_px;
      owner = k;
    }
    if (owner) parts[*owner].push_back(i);
  }
  return parts;
}

ImageBox project_box(const Extent& extent, const Projection& projection, const RoadPlane& road) {
  const auto corner = [&](double azimuth_rad, double height_m) {
    const double x = extent.near_m * std::cos(azimuth_rad), y = extent.near_m * std::sin(azimuth_rad);
    return projection.project({x, y, road.z_m(x, y) + height_m});
  };
  const auto top_left = corner(extent.left_rad, extent.top_m), bottom_right = corner(extent.right_rad, 0.0);
  return {top_left.u_px, top_left.v_px, bottom_right.u_px - top_left.u_px, bottom_right.v_px - top_left.v_px};
}

}  // namespace

Assembly assemble_obstacles(const std::vector<Candidate>& candidates, const Population& flies,
                            const std::vector<DroppedFly>& dropped, const Projection& projection, const RoadPlane& road,
                            const ConcentrateOptions& options) {
  auto parts = divide_flies(candidates, flies, dropped, options);
  std::erase_if(parts, [&](const Indices& part) { return part.empty(); });
  if (options.assemble.merge) parts = join_parts(std::move(parts), flies, road, options.assemble);

  struct Assembled {
    Obstacle obstacle;
    Indices members;
  };
  std::vector<Assembled> assembled;
  for (auto& members : parts) {
    const auto extent = measure(members, flies, road, options.assemble.near_quantile);
    if (static_cast<int>(members.size()) < options.assemble.min_flies || extent.top_m < options.assemble.min_height_m)
      continue;
    const double azimuth_rad = 0.5 * (extent.left_rad + extent.right_rad);
    Obstacle obstacle;
    obstacle.range_m = extent.near_m;
    obstacle.x_m = extent.near_m * std::cos(azimuth_rad);
    obstacle.y_m = extent.near_m * std::sin(azimuth_rad);
    obstacle.width_m = extent.width_m();
    obstacle.height_m = extent.top_m;
    obstacle.ground_z_m = road.z_m(obstacle.x_m, obstacle.y_m);
    obstacle.box = project_box(extent, projection, road);
    for (const auto i : members) obstacle.score += flies.fitness[i];
    obstacle.score /= static_cast<double>(flies.size());
    assembled.push_back({obstacle, std::move(members)});
  }
  std::stable_sort(assembled.begin(), assembled.end(),
                   [](const auto& a, const auto& b) { return a.obstacle.range_m < b.obstacle.range_m; });

  Assembly result{{}, std::vector<int>(flies.size(), -1)};
  for (auto& [obstacle, members] : assembled) {
    for (const auto i : members) result.obstacle_of_fly[i] = static_cast<int>(result.obstacles.size());
    result.obstacles.push_back(obstacle);
  }
  return result;
}

}  // namespace flies
