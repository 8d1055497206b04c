#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "flies/concentrate/ascending_order.hpp"
#include "flies/core/field.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/road.hpp"

namespace flies {

/// Flies as a laser scanner on the left camera would have measured them, from right to left: a sighting is one such
/// measurement. A structure of arrays, in the precision of the flies themselves.
struct Sightings {
  std::vector<std::uint32_t> fly;  ///< index into the population
  std::vector<float> tangent;      ///< of the azimuth, y / x; ascending
  std::vector<float> x_m, y_m;     ///< vehicle frame
  std::vector<float> range_m;      ///< along the ground
  std::vector<float> height_m;     ///< above the road
  std::vector<float> fitness;      ///< > 0

  std::size_t size() const { return fly.size(); }
  void reserve(std::size_t count);
  void resize(std::size_t count);
};

/// Turns flies into sightings, keeping memory from call to call.
class FlySighter {
 public:
  void reserve(std::size_t flies);

  /// Takes the flies that count: those with fitness in the field of detection (crossover may have made others),
  /// whose `x_min_m` must be positive.
  /// @param sightings is filled
  void sight(const Population& flies, const RoadPlane& road, const FieldOptions& field, Sightings& sightings);

 private:
  AscendingOrder order_;
  std::vector<std::uint32_t> counted_;  ///< the flies that count, in the order of the population
  std::vector<float> tangent_;          ///< of their azimuths
};

}  // namespace flies
