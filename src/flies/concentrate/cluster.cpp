#include "flies/concentrate/concentrate.hpp"
#include "flies/concentrate/disjoint_sets.hpp"

namespace flies {

namespace {

double squared_distance(const PixelPoint& a, const PixelPoint& b) {
  const double du = a.u_px - b.u_px, dv = a.v_px - b.v_px;
  return du * du + dv * dv;
}

}  // namespace

std::vector<PixelPoint> cluster_points(const std::vector<PixelPoint>& points, double radius_px) {
  DisjointSets sets(points.size());
  for (std::size_t a = 0; a < points.size(); ++a)
    for (std::size_t b = a + 1; b < points.size(); ++b)
      if (squared_distance(points[a], points[b]) <= radius_px * radius_px) sets.join(a, b);

  std::vector<PixelPoint> centres;
  for (const auto& group : sets.groups()) {
    PixelPoint centre;
    for (const auto i : group) {
      centre.u_px += points[i].u_px / static_cast<double>(group.size());
      centre.v_px += points[i].v_px / static_cast<double>(group.size());
    }
    centres.push_back(centre);
  }
  return centres;
}

}  // namespace flies
