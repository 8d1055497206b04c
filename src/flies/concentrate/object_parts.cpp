#include "flies/concentrate/object_parts.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

namespace flies {
namespace {

/// Quantiles that bound an object: a few stray flies at either end do not stretch it.
constexpr double kLowEdge = 0.05, kHighEdge = 0.95;

/// The far end of an object is that of far fewer flies, which match worse, than its near face.
constexpr double kFarQuantile = 0.85;

/// Parts whose gaps are below this share of those allowed are taken for one surface.
constexpr double kSurfaceGap = 0.5;

struct WeightedValue {
  double value = 0.0;
  double weight = 0.0;
};

/// The smallest value up to which `quantile` of the total weight lies. `samples` must be sorted by value.
double weighted_quantile(const std::vector<WeightedValue>& samples, double quantile) {
  double total = 0.0;
  for (const auto& sample : samples) total += sample.weight;
  double passed = 0.0;
  for (const auto& sample : samples)
    if ((passed += sample.weight) >= quantile * total) return sample.value;
  return samples.back().value;
}

void sort_by_value(std::vector<WeightedValue>& samples) {
  std::sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
}

Extent measure(const std::vector<std::size_t>& members, const Population& flies, const RoadPlane& road,
               double near_quantile) {
  std::vector<WeightedValue> range_m, azimuth_rad, height_m;
  for (const auto i : members) {
    const double x = flies.x_m[i], y = flies.y_m[i], weight = flies.fitness[i];
    // The fittest flies sit closest to the surface. Weighed by fitness alone, the near face of a distant object would
    // be the noise of its poorer flies.
    range_m.push_back({std::hypot(x, y), weight * weight});
    azimuth_rad.push_back({std::atan2(y, x), weight});
    height_m.push_back({flies.z_m[i] - road.z_m(x, y), weight});
  }
  sort_by_value(range_m);
  sort_by_value(azimuth_rad);
  sort_by_value(height_m);
  return {weighted_quantile(range_m, near_quantile), weighted_quantile(range_m, std::max(near_quantile, kFarQuantile)),
          weighted_quantile(azimuth_rad, kLowEdge),  weighted_quantile(azimuth_rad, kHighEdge),
          weighted_quantile(height_m, kLowEdge),     weighted_quantile(height_m, kHighEdge)};
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
              [](const Echo& a, const Echo& b) { return a.azimuth_rad < b.azimuth_rad; });
  }

  /// Summed fitness of the flies between two azimuths and farther than `range_m`.
  double fitness_behind(double right_rad, double left_rad, double range_m) const {
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

double gap(double low_a, double high_a, double low_b, double high_b) {
  return std::max({0.0, low_b - high_a, low_a - high_b});
}

/// How far two parts are apart, as a share of the gaps that are allowed inside an object; nothing when they cannot
/// belong together.
std::optional<double> separation(const Part& a, const Part& b, const Backdrop& backdrop,
                                 const AssembleOptions& options) {
  const Extent &ea = a.extent, &eb = b.extent;
  const double near_m = std::min(ea.near_m, eb.near_m), far_m = std::max(ea.far_m, eb.far_m);
  const double depth = gap(ea.near_m, ea.far_m, eb.near_m, eb.far_m) / (options.depth_gap_share * near_m);
  const double lateral = near_m * gap(ea.right_rad, ea.left_rad, eb.right_rad, eb.left_rad) / options.lateral_gap_m;
  if (!(depth <= 1.0 && lateral <= 1.0)) return {};

  const double width_m = near_m * (std::max(ea.left_rad, eb.left_rad) - std::min(ea.right_rad, eb.right_rad));
  const double size_m = std::max(width_m, far_m - near_m);
  const bool one_surface = lateral <= kSurfaceGap && depth <= kSurfaceGap;
  if (size_m > options.max_width_m && !(one_surface && size_m <= options.max_surface_m)) return {};

  const double gap_right_rad = std::min(ea.left_rad, eb.left_rad), gap_left_rad = std::max(ea.right_rad, eb.right_rad);
  if (near_m * (gap_left_rad - gap_right_rad) <= options.see_through_gap_m) return std::hypot(depth, lateral);
  const double behind = backdrop.fitness_behind(gap_right_rad, gap_left_rad, far_m * (1.0 + options.depth_gap_share));
  if (behind > options.see_through_share * std::min(a.fitness, b.fitness)) return {};
  return std::hypot(depth, lateral);
}

Part join(const Part& a, const Part& b, const Population& flies, const RoadPlane& road,
          const AssembleOptions& options) {
  auto members = a.members;
  members.insert(members.end(), b.members.begin(), b.members.end());
  const auto& densest = a.candidate.density >= b.candidate.density ? a.candidate : b.candidate;
  return make_part(std::move(members), densest, flies, road, options);
}

}  // namespace

Part make_part(std::vector<std::size_t> members, const Candidate& candidate, const Population& flies,
               const RoadPlane& road, const AssembleOptions& options) {
  assert(!members.empty());
  Part part{std::move(members), candidate, {}, 0.0};
  part.extent = measure(part.members, flies, road, options.near_quantile);
  for (const auto i : part.members) part.fitness += flies.fitness[i];
  return part;
}

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
    parts[best_a] = join(parts[best_a], parts[best_b], flies, road, options);
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(best_b));
  }
}

}  // namespace flies
