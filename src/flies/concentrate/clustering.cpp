#include "flies/concentrate/clustering.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "flies/concentrate/concentrate.hpp"
#include "flies/core/error.hpp"
#include "flies/core/options.hpp"

namespace flies {
namespace {

double squared_distance(const PixelPoint& a, const PixelPoint& b) {
  const double du = a.u_px - b.u_px, dv = a.v_px - b.v_px;
  return du * du + dv * dv;
}

}  // namespace

void Clustering::reserve(std::size_t points) {
  for (auto* values : {&by_column_, &parent_, &members_, &group_}) values->reserve(points);
  centres_.reserve(points);
}

std::uint32_t Clustering::leader(std::uint32_t point) const {
  while (parent_[point] != point) point = parent_[point];
  return point;
}

void Clustering::join(std::uint32_t a, std::uint32_t b) {
  a = leader(a);
  b = leader(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

const std::vector<PixelPoint>& Clustering::cluster(std::span<const PixelPoint> points, double radius_px) {
  const auto count = static_cast<std::uint32_t>(points.size());
  parent_.resize(count);
  std::iota(parent_.begin(), parent_.end(), 0U);
  by_column_ = parent_;
  std::sort(by_column_.begin(), by_column_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return points[a].u_px < points[b].u_px; });
  for (auto a = by_column_.begin(); a != by_column_.end(); ++a)
    for (auto b = a + 1; b != by_column_.end() && points[*b].u_px - points[*a].u_px <= radius_px; ++b)
      if (squared_distance(points[*a], points[*b]) <= radius_px * radius_px) join(*a, *b);

  members_.assign(count, 0);
  group_.resize(count);
  centres_.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto first = leader(i);
    if (first == i) {
      group_[i] = static_cast<std::uint32_t>(centres_.size());
      centres_.emplace_back();
    }
    ++members_[first];
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto first = leader(i);
    auto& centre = centres_[group_[first]];
    centre.u_px += points[i].u_px / members_[first];
    centre.v_px += points[i].v_px / members_[first];
  }
  return centres_;
}

std::vector<PixelPoint> cluster_points(const std::vector<PixelPoint>& points, double radius_px) {
  if (!(std::isfinite(radius_px) && radius_px > 0.0))
    throw InputError("cluster_points", "radius_px",
                     "found " + detail::double_text(radius_px) + ", expected a number above 0");
  return Clustering().cluster(points, radius_px);
}

}  // namespace flies
