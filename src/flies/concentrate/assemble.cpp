#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "flies/concentrate/concentrate.hpp"

namespace flies {
namespace {

/// Quantiles that bound an object: a few stray flies at either end do not stretch it.
constexpr double kLowEdge = 0.05, kHighEdge = 0.95;

using Indices = std::vector<std::size_t>;

/// Where an object is seen from the camera, like the echo of a laser scanner: range and azimuth intervals.
struct Extent {
  double near_m = 0.0, far_m = 0.0;  ///< range along the ground
  double right_rad = 0.0, left_rad = 0.0;
  double bottom_m = 0.0, top_m = 0.0;  ///< of its flies, above the road

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
          weighted_quantile(azimuth_rad, kLowEdge),  weighted_quantile(azimuth_rad, kHighEdge),
          weighted_quantile(height_m, kLowEdge),     weighted_quantile(height_m, kHighEdge)};
}

double gap(double low_a, double high_a, double low_b, double high_b) {
  return std::max({0.0, low_b - high_a, low_a - high_b});
}

/// All flies as seen from the camera, sorted by azimuth: what lies behind the gap between two parts.
class Backdrop {
 public:
  explicit Backdrop(const Population& flies) {
    for (std::size_t i = 0; i < flies.size(); ++i)
      if (flies.fitness[i] > 0.0F)
        echoes_.push_back(
            {std::atan2(flies.y_m[i], flies.x_m[i]), std::hypot(flies.x_m[i], flies.y_m[i]), flies.fitness[i]});
    std::sort(echoes_.begin(), echoes_.end(),
              [](const auto& a, const auto& b) { return a.azimuth_rad < b.azimuth_rad; });
  }

  /// Summed fitness of the flies between two azimuths and farther than `range_m`.
  double behind(double right_rad, double left_rad, double range_m) const {
    auto echo = std::lower_bound(echoes_.begin(), echoes_.end(), right_rad,
                                 [](const Echo& e, double azimuth_rad) { return e.azimuth_rad < azimuth_rad; });
    double sum = 0.0;
    for (; echo != echoes_.end() && echo->azimuth_rad < left_rad; ++echo)
      if (echo->range_m > range_m) sum += echo->fitness;
    return sum;
  }

 private:
  struct Echo {
    double azimuth_rad, range_m, fitness;
  };
  std::vector<Echo> echoes_;
};

struct Part {
  Indices members;
  Extent extent;
  double fitness = 0.0;  ///< summed over its members
};

/// How far two parts are apart, as a share of the gaps that are allowed inside an object; nothing when they cannot
/// belong together: too far apart, too large together, or something farther away is seen between them.
std::optional<double> separation(const Part& a, const Part& b, const Backdrop& backdrop,
                                 const AssembleOptions& options) {
  const Extent &ea = a.extent, &eb = b.extent;
  const double range_m = std::min(ea.near_m, eb.near_m);
  const double depth = gap(ea.near_m, ea.far_m, eb.near_m, eb.far_m) / (options.depth_gap_share * range_m);
  const double lateral = range_m * gap(ea.right_rad, ea.left_rad, eb.right_rad, eb.left_rad) / options.lateral_gap_m;
  const double width_m = range_m * (std::max(ea.left_rad, eb.left_rad) - std::min(ea.right_rad, eb.right_rad));
  const double depth_m = std::max(ea.far_m, eb.far_m) - range_m;
  if (depth > 1.0 || lateral > 1.0 || width_m > options.max_width_m || depth_m > options.max_width_m) return {};
  const double gap_right_rad = std::min(ea.left_rad, eb.left_rad), gap_left_rad = std::max(ea.right_rad, eb.right_rad);
  if (gap_left_rad > gap_right_rad) {
    const double far_m = std::max(ea.far_m, eb.far_m) * (1.0 + options.depth_gap_share);
    const double seen_through = backdrop.behind(gap_right_rad, gap_left_rad, far_m);
    if (seen_through > options.see_through_share * std::min(a.fitness, b.fitness)) return {};
  }
  return std::hypot(depth, lateral);
}

Part make_part(Indices members, const Population& flies, const RoadPlane& road, const AssembleOptions& options) {
  Part part{std::move(members), {}, 0.0};
  part.extent = measure(part.members, flies, road, options.near_quantile);
  for (const auto i : part.members) part.fitness += flies.fitness[i];
  return part;
}

/// Joins parts, closest first, as long as the whole stays within the largest size of an object.
std::vector<Part> join_parts(std::vector<Part> parts, const Population& flies, const RoadPlane& road,
                             const AssembleOptions& options) {
  const Backdrop backdrop(flies);
  while (true) {
    std::size_t best_a = 0, best_b = 0;
    std::optional<double> best;
    for (std::size_t a = 0; a < parts.size(); ++a)
      for (std::size_t b = a + 1; b < parts.size(); ++b)
        if (const auto s = separation(parts[a], parts[b], backdrop, options); s && (!best || *s < *best)) {
          best = s;
          best_a = a;
          best_b = b;
        }
    if (!best) return parts;
    auto members = std::move(parts[best_a].members);
    members.insert(members.end(), parts[best_b].members.begin(), parts[best_b].members.end());
    parts[best_a] = make_part(std::move(members), flies, road, options);
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(best_b));
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
  std::vector<Part> parts;
  for (auto& members : divide_flies(candidates, flies, dropped, options))
    if (!members.empty()) parts.push_back(make_part(std::move(members), flies, road, options.assemble));
  if (options.assemble.merge) parts = join_parts(std::move(parts), flies, road, options.assemble);

  struct Assembled {
    Obstacle obstacle;
    Indices members;
  };
  std::vector<Assembled> assembled;
  for (auto& [members, extent, fitness] : parts) {
    if (static_cast<int>(members.size()) < options.assemble.min_flies || extent.top_m < options.assemble.min_height_m ||
        std::max(extent.width_m(), extent.top_m - extent.bottom_m) < options.assemble.min_extent_m)
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
    obstacle.score = fitness / static_cast<double>(flies.size());
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
