#include "flies/concentrate/object_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace flies {
namespace {

/// Quantiles that bound an object: a few stray flies at either end do not stretch it.
constexpr double kLowEdge = 0.05, kHighEdge = 0.95;

/// The far end of an object is that of far fewer flies, which match worse, than its near face.
constexpr double kFarQuantile = 0.85;

/// Parts whose gaps are below this share of those allowed are taken for one surface.
constexpr double kSurfaceGap = 0.5;

/// Room for more neighbours than a part has in a street.
constexpr std::size_t kNeighboursAPart = 32;

/// A separation that keeps parts apart.
constexpr double kApart = std::numeric_limits<double>::infinity();

/// The smallest values up to which `low` and `high` of the total weight lie, in a list that starts with `fly`.
template <class Weight>
std::pair<double, double> weighted_quantiles(std::uint32_t fly, std::span<const std::uint32_t> next,
                                             std::span<const float> values, const Weight& weight, double total,
                                             double low, double high) {
  double passed = weight(fly);
  const auto value_at = [&](double quantile) {
    for (; passed < quantile * total && next[fly] != kNone; passed += weight(fly)) fly = next[fly];
    return static_cast<double>(values[fly]);
  };
  const double low_value = value_at(low);
  return {low_value, value_at(high)};
}

/// Merges two lists that are sorted by `values`. @returns the first of the merged
std::uint32_t merge(std::uint32_t a, std::uint32_t b, std::span<const float> values, std::span<std::uint32_t> next) {
  std::uint32_t first = kNone;
  std::uint32_t* link = &first;
  while (a != kNone && b != kNone) {
    // Which one comes first cannot be predicted: no branch.
    const bool b_first = values[b] < values[a];
    const auto least = b_first ? b : a;
    *link = least;
    link = &next[least];
    const auto following = *link;
    a = b_first ? a : following;
    b = b_first ? following : b;
  }
  *link = a != kNone ? a : b;
  return first;
}

/// Summed fitness of the flies between two azimuths and farther than `range_m`: what lies behind the gap between two
/// parts.
double fitness_behind(const Sightings& flies, double right_rad, double left_rad, double range_m) {
  const auto tangent = [](double azimuth_rad) { return static_cast<float>(std::tan(azimuth_rad)); };
  const float left = tangent(left_rad);
  auto i = static_cast<std::size_t>(std::lower_bound(flies.tangent.begin(), flies.tangent.end(), tangent(right_rad)) -
                                    flies.tangent.begin());
  double sum = 0.0;
  for (; i < flies.size() && flies.tangent[i] < left; ++i)
    if (flies.range_m[i] > range_m) sum += flies.fitness[i];
  return sum;
}

double gap(double low_a, double high_a, double low_b, double high_b) {
  return std::max({0.0, low_b - high_a, low_a - high_b});
}

double lateral_gap_m(const Extent& a, const Extent& b) {
  return std::min(a.near_m, b.near_m) * gap(a.right_rad, a.left_rad, b.right_rad, b.left_rad);
}

/// The separation of two parts that are not too far apart across.
double separation_of_neighbours(const Part& a, const Part& b, const Sightings& flies, const AssembleOptions& options) {
  const Extent &ea = a.extent, &eb = b.extent;
  const double near_m = std::min(ea.near_m, eb.near_m), far_m = std::max(ea.far_m, eb.far_m);
  const auto share_of = [](double gap_m, double most_m) { return gap_m > 0.0 ? gap_m / most_m : 0.0; };
  const double depth = share_of(gap(ea.near_m, ea.far_m, eb.near_m, eb.far_m), options.depth_gap_share * near_m);
  const double lateral = share_of(lateral_gap_m(ea, eb), options.lateral_gap_m);
  if (!(depth <= 1.0 && lateral <= 1.0)) return kApart;

  const double width_m = near_m * (std::max(ea.left_rad, eb.left_rad) - std::min(ea.right_rad, eb.right_rad));
  const double size_m = std::max(width_m, far_m - near_m);
  const bool one_surface = lateral <= kSurfaceGap && depth <= kSurfaceGap;
  if (size_m > options.max_width_m && !(one_surface && size_m <= options.max_surface_m)) return kApart;

  const double gap_right_rad = std::min(ea.left_rad, eb.left_rad), gap_left_rad = std::max(ea.right_rad, eb.right_rad);
  if (near_m * (gap_left_rad - gap_right_rad) <= options.see_through_gap_m) return std::hypot(depth, lateral);
  const double behind = fitness_behind(flies, gap_right_rad, gap_left_rad, far_m * (1.0 + options.depth_gap_share));
  if (behind > options.see_through_share * std::min(a.fitness, b.fitness)) return kApart;
  return std::hypot(depth, lateral);
}

/// How far two parts are apart, as a share of the gaps that are allowed inside an object; `kApart` when they cannot
/// belong together, as most cannot.
inline double separation(const Part& a, const Part& b, const Sightings& flies, const AssembleOptions& options) {
  return lateral_gap_m(a.extent, b.extent) > options.lateral_gap_m ? kApart
                                                                   : separation_of_neighbours(a, b, flies, options);
}

}  // namespace

void ObjectParts::reserve(std::size_t flies, std::size_t candidates) {
  parts_.reserve(candidates);
  owned_.reserve(flies);
  values_.reserve(flies);
  for (auto& next : next_) next.reserve(flies);
  order_.reserve(flies);
  neighbours_.reserve(kNeighboursAPart * candidates);
}

void ObjectParts::measure(Part& part, double near_quantile) const {
  const auto fitness = [&](std::uint32_t i) { return static_cast<double>(flies_->fitness[i]); };
  // The fittest flies sit closest to the surface. Weighed by fitness alone, the near face of a distant object would
  // be the noise of its poorer flies.
  const auto squared_fitness = [&](std::uint32_t i) { return fitness(i) * fitness(i); };
  auto& extent = part.extent;
  const auto quantiles = [&](Order order, const auto& weight, double total, double low, double high) {
    return weighted_quantiles(part.first[order], next_[order], values(order), weight, total, low, high);
  };
  std::tie(extent.near_m, extent.far_m) =
      quantiles(kByRange, squared_fitness, part.squared_fitness, near_quantile, std::max(near_quantile, kFarQuantile));
  const auto [right, left] = quantiles(kByAzimuth, fitness, part.fitness, kLowEdge, kHighEdge);
  extent.right_rad = std::atan(right);
  extent.left_rad = std::atan(left);
  std::tie(extent.bottom_m, extent.top_m) = quantiles(kByHeight, fitness, part.fitness, kLowEdge, kHighEdge);
}

std::span<const float> ObjectParts::values(Order order) const {
  const std::array<std::span<const float>, kOrders> all = {flies_->range_m, flies_->tangent, flies_->height_m};
  return all[order];
}

void ObjectParts::find_owned(std::span<const std::uint32_t> owner) {
  // Every fly is written, and overwritten by the next one unless somebody owns it: a branch would be mispredicted.
  owned_.resize(owner.size());
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < owner.size(); ++i) {
    owned_[count] = i;
    count += owner[i] != kNone ? 1 : 0;
  }
  owned_.resize(count);
}

void ObjectParts::sum_up(std::span<const std::uint32_t> owner) {
  for (auto fly = owned_.rbegin(); fly != owned_.rend(); ++fly) {
    auto& part = parts_[owner[*fly]];
    const double fitness = flies_->fitness[*fly];
    ++part.flies;
    part.fitness += fitness;
    part.squared_fitness += fitness * fitness;
  }
}

void ObjectParts::link(Order order, std::span<const std::uint32_t> owner) {
  // The last in the order is linked first: each fly goes before those of its part that are linked already.
  auto& next = next_[order];
  next.resize(flies_->size());
  const auto prepend = [&](std::uint32_t fly) { next[fly] = std::exchange(parts_[owner[fly]].first[order], fly); };
  if (order == kByAzimuth) {  // the order that sightings come in
    std::for_each(owned_.rbegin(), owned_.rend(), prepend);
    return;
  }
  values_.resize(owned_.size());
  for (std::size_t k = 0; k < owned_.size(); ++k) values_[k] = values(order)[owned_[k]];
  const auto ascending = order_.find(values_);
  for (auto k = owned_.size(); k-- > 0;) prepend(owned_[ascending[k]]);
}

void ObjectParts::gather(const Sightings& flies, std::span<const Candidate> candidates,
                         std::span<const std::uint32_t> owner, double near_quantile) {
  flies_ = &flies;
  parts_.clear();
  for (const auto& candidate : candidates) parts_.emplace_back().candidate = candidate;
  find_owned(owner);
  sum_up(owner);
  for (const auto order : {kByAzimuth, kByRange, kByHeight}) link(order, owner);
  std::erase_if(parts_, [](const Part& part) { return part.flies == 0; });
  for (auto& part : parts_) measure(part, near_quantile);
}

void ObjectParts::join(Part& part, Part& other, double near_quantile) {
  if (other.candidate.density > part.candidate.density) part.candidate = other.candidate;
  part.flies += std::exchange(other.flies, 0);  // marks the other as joined
  part.fitness += other.fitness;
  part.squared_fitness += other.squared_fitness;
  for (const auto order : {kByRange, kByAzimuth, kByHeight})
    part.first[order] = merge(part.first[order], other.first[order], values(order), next_[order]);
  measure(part, near_quantile);
}

void ObjectParts::join(const AssembleOptions& options) {
  const auto count = static_cast<std::uint32_t>(parts_.size());
  const auto note = [&](std::uint32_t first, std::uint32_t second) {
    const double apart = separation(parts_[first], parts_[second], *flies_, options);
    if (apart < kApart) neighbours_.push_back({apart, first, second});
  };
  neighbours_.clear();
  for (std::uint32_t first = 0; first < count; ++first)
    for (std::uint32_t second = first + 1; second < count; ++second) note(first, second);
  while (!neighbours_.empty()) {
    const auto [apart, first, second] = *std::min_element(neighbours_.begin(), neighbours_.end());
    join(parts_[first], parts_[second], options.near_quantile);
    const auto is_old = [first = first, second = second](const Neighbours& pair) {
      return pair.first == first || pair.second == first || pair.first == second || pair.second == second;
    };
    std::erase_if(neighbours_, is_old);
    for (std::uint32_t other = 0; other < count; ++other)
      if (other != first && parts_[other].flies > 0) note(std::min(first, other), std::max(first, other));
  }
  std::erase_if(parts_, [](const Part& part) { return part.flies == 0; });
}

}  // namespace flies
