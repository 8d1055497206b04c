#pragma once

#include <optional>
#include <vector>

#include "flies/core/ground_point.hpp"
#include "flies/core/scan.hpp"

namespace flies {

/// The ground that was seen free, as a polygon around the point below the left camera: the origin, then for every
/// sector, from right to left, the ends of its right and left edge. Sectors that are unknown or have no free ground are
/// left out: the polygon goes back to the origin between their neighbours. Empty when no ground was seen free. The line
/// from the last vertex to the first closes it.
std::vector<GroundPoint> free_space(const Scan& scan);

/// The range up to which a sector's ground is part of `free_space`, 0 where it is not.
double drivable_m(const Scan& scan, std::size_t sector);

/// The sector that an angle falls into; nothing when it lies outside the scan or is not finite.
std::optional<std::size_t> sector_at(const Scan& scan, double angle_rad);

}  // namespace flies
