#include "flies/core/free_space.hpp"

#include <cmath>

namespace flies {

std::vector<GroundPoint> free_space(const Scan& scan) {
  std::vector<GroundPoint> vertices;
  bool at_origin = false;
  for (std::size_t sector = 0; sector < scan.size(); ++sector) {
    const double range_m = drivable_m(scan, sector);
    if (range_m > 0.0) {
      if (vertices.empty()) vertices.push_back({0.0, 0.0});
      for (const double half : {-0.5, 0.5}) {
        const double edge_rad = scan.angle_rad(sector) + half * scan.angle_increment_rad;
        vertices.push_back({range_m * std::cos(edge_rad), range_m * std::sin(edge_rad)});
      }
      at_origin = false;
    } else if (!vertices.empty() && !at_origin) {
      vertices.push_back({0.0, 0.0});
      at_origin = true;
    }
  }
  if (at_origin) vertices.pop_back();  // the closing line goes there anyway
  return vertices;
}

double drivable_m(const Scan& scan, std::size_t sector) {
  const double free_m = scan.free_m[sector];
  return scan.states[sector] != SectorState::unknown && std::isfinite(free_m) && free_m > 0.0 ? free_m : 0.0;
}

std::optional<std::size_t> sector_at(const Scan& scan, double angle_rad) {
  const double sector = std::floor((angle_rad - scan.angle_min_rad) / scan.angle_increment_rad + 0.5);
  if (!(sector >= 0.0 && sector < static_cast<double>(scan.size()))) return std::nullopt;
  return static_cast<std::size_t>(sector);
}

}  // namespace flies
