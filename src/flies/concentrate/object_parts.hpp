#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "flies/concentrate/concentrate.hpp"

namespace flies {

/// Where something is seen from the camera, like the echo of a laser scanner: intervals of range and azimuth, and of
/// height above the road.
struct Extent {
  double near_m = 0.0, far_m = 0.0;  ///< range along the ground
  double right_rad = 0.0, left_rad = 0.0;
  double bottom_m = 0.0, top_m = 0.0;

  double width_m() const { return near_m * (left_rad - right_rad); }
  double azimuth_rad() const { return 0.5 * (right_rad + left_rad); }
};

/// A fly as a laser scanner would have measured it.
struct Echo {
  double range_m = 0.0;  ///< along the ground
  double azimuth_rad = 0.0;
  double height_m = 0.0;  ///< above the road
  double fitness = 0.0;
};

/// One echo per fly, same order; flies without fitness are left blank.
std::vector<Echo> measure_echoes(const Population& flies, const RoadPlane& road);

/// A measured value of a fly and how much it counts.
struct WeightedValue {
  double value = 0.0;
  double weight = 0.0;
};

/// A candidate with the flies that belong to it: an object, or a part of one until it is joined to others.
struct Part {
  std::vector<std::size_t> members;  ///< indices of its flies
  Candidate candidate;               ///< the densest of those joined
  Extent extent;                     ///< of its flies
  double fitness = 0.0;              ///< summed over its flies
  /// What the extent is measured from, each sorted by value, so that joining is merging.
  std::vector<WeightedValue> ranges_m, azimuths_rad, heights_m;
};

/// Measures a part from its flies; `members` must not be empty.
Part make_part(std::vector<std::size_t> members, const Candidate& candidate, std::span<const Echo> echoes,
               const AssembleOptions& options);

/// Joins parts of one object, closest first: the gaps between them in range and sideways are small, the whole is no
/// larger than an object may be, and nothing farther away is seen through the gap.
std::vector<Part> join_parts(std::vector<Part> parts, std::span<const Echo> echoes, const AssembleOptions& options);

}  // namespace flies
