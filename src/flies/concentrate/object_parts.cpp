#include "flies/concentrate/object_parts.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
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

/// The smallest value up to which `quantile` of the total weight lies. `samples` must be sorted by value.
double weighted_quantile(const std::vector<WeightedValue>& samples, double quantile) {
  double total = 0.0;
  for (const auto& sample : samples) total += sample.weight;
  double passed = 0.0;
  for (const auto& sample : samples)
    if ((passed += sample.weight) >= quantile * total) return sample.value;
  return samples.back().value;
}

bool is_less(const WeightedValue& a, const WeightedValue& b) { return a.value < b.value; }

std::vector<WeightedValue> merge(const std::vector<WeightedValue>& a, const std::vector<WeightedValue>& b) {
  std::vector<WeightedValue> all(a.size() + b.size());
  std::merge(a.begin(), a.end(), b.begin(), b.end(), all.begin(), is_less);
  return all;
}

Extent measure(const Part& part, double near_quantile) {
  return {weighted_quantile(part.ranges_m, near_quantile),
          weighted_quantile(part.ranges_m, std::max(near_quantile, kFarQuantile)),
          weighted_quantile(part.azimuths_rad, kLowEdge),
          weighted_quantile(part.azimuths_rad, kHighEdge),
          weighted_quantile(part.heights_m, kLowEdge),
          weighted_quantile(part.heights_m, kHighEdge)};
}

/// All flies as seen from the camera, sorted by azimuth: what lies behind the gap between two parts.
class Backdrop {
 public:
  explicit Backdrop(std::span<const Echo> echoes) {
    for (const auto& echo : echoes)
      if (echo.fitness > 0.0) echoes_.push_back(echo);
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

Part join(const Part& a, const Part& b, const AssembleOptions& options) {
  Part whole{a.members,
             a.candidate.density >= b.candidate.density ? a.candidate : b.candidate,
             {},
             a.fitness + b.fitness,
             merge(a.ranges_m, b.ranges_m),
             merge(a.azimuths_rad, b.azimuths_rad),
             merge(a.heights_m, b.heights_m)};
  whole.members.insert(whole.members.end(), b.members.begin(), b.members.end());
  whole.extent = measure(whole, options.near_quantile);
  return whole;
}

}  // namespace

std::vector<Echo> measure_echoes(const Population& flies, const RoadPlane& road) {
  std::vector<Echo> echoes(flies.size());
  for (std::size_t i = 0; i < flies.size(); ++i) {
    if (!(flies.fitness[i] > 0.0F)) continue;
    const double x = flies.x_m[i], y = flies.y_m[i];
    echoes[i] = {std::sqrt(x * x + y * y), std::atan2(y, x), flies.z_m[i] - road.z_m(x, y), flies.fitness[i]};
  }
  return echoes;
}

Part make_part(std::vector<std::size_t> members, const Candidate& candidate, std::span<const Echo> echoes,
               const AssembleOptions& options) {
  assert(!members.empty());
  Part part{std::move(members), candidate, {}, 0.0, {}, {}, {}};
  for (const auto i : part.members) {
    const auto& echo = echoes[i];
    part.fitness += echo.fitness;
    // The fittest flies sit closest to the surface. Weighed by fitness alone, the near face of a distant object would
    // be the noise of its poorer flies.
    part.ranges_m.push_back({echo.range_m, echo.fitness * echo.fitness});
    part.azimuths_rad.push_back({echo.azimuth_rad, echo.fitness});
    part.heights_m.push_back({echo.height_m, echo.fitness});
  }
  for (auto* values : {&part.ranges_m, &part.azimuths_rad, &part.heights_m})
    std::sort(values->begin(), values->end(), is_less);
  part.extent = measure(part, options.near_quantile);
  return part;
}

std::vector<Part> join_parts(std::vector<Part> parts, std::span<const Echo> echoes, const AssembleOptions& options) {
  const Backdrop backdrop(echoes);
  // Row a holds the separations of part a from the parts after it; a join changes one row and one column.
  constexpr double kApart = std::numeric_limits<double>::infinity();
  const std::size_t stride = parts.size();
  std::vector<double> separations(stride * stride, kApart);
  const auto update = [&](std::size_t a, std::size_t b) {
    separations[std::min(a, b) * stride + std::max(a, b)] =
        separation(parts[std::min(a, b)], parts[std::max(a, b)], backdrop, options).value_or(kApart);
  };
  for (std::size_t a = 0; a < stride; ++a)
    for (std::size_t b = a + 1; b < stride; ++b) update(a, b);
  while (true) {
    const auto least = std::min_element(separations.begin(), separations.end());
    if (least == separations.end() || *least == kApart) break;
    const auto index = static_cast<std::size_t>(least - separations.begin());
    const std::size_t a = index / stride, b = index % stride;
    parts[a] = join(parts[a], parts[b], options);
    parts[b].members.clear();  // marks it as joined
    for (std::size_t k = 0; k < stride; ++k) {
      if (k != b) separations[std::min(k, b) * stride + std::max(k, b)] = kApart;
      if (k != a && !parts[k].members.empty()) update(a, k);
    }
  }
  std::erase_if(parts, [](const Part& part) { return part.members.empty(); });
  return parts;
}

}  // namespace flies
