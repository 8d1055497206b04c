#include "flies/concentrate/sightings.hpp"

#include <cmath>

namespace flies {

void Sightings::reserve(std::size_t count) {
  fly.reserve(count);
  for (auto* values : {&tangent, &x_m, &y_m, &range_m, &height_m, &fitness}) values->reserve(count);
}

void Sightings::resize(std::size_t count) {
  fly.resize(count);
  for (auto* values : {&tangent, &x_m, &y_m, &range_m, &height_m, &fitness}) values->resize(count);
}

void FlySighter::reserve(std::size_t flies) {
  order_.reserve(flies);
  heard_.reserve(flies);
  tangent_.reserve(flies);
}

void FlySighter::sight(const Population& flies, const RoadPlane& road, const FieldOptions& field,
                       Sightings& sightings) {
  // Every fly is written, and overwritten by the next one unless it has a say: a branch would be mispredicted.
  heard_.resize(flies.size());
  tangent_.resize(flies.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < flies.size(); ++i) {
    heard_[count] = static_cast<std::uint32_t>(i);
    tangent_[count] = flies.y_m[i] / flies.x_m[i];
    count += (flies.fitness[i] > 0.0F) & in_field(field, road, flies.point(i)) ? 1 : 0;
  }
  heard_.resize(count);
  tangent_.resize(count);

  sightings.resize(count);
  const auto from_right = order_.find(tangent_);
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = heard_[from_right[k]];
    const float x = flies.x_m[i], y = flies.y_m[i];
    sightings.fly[k] = i;
    sightings.tangent[k] = tangent_[from_right[k]];
    sightings.x_m[k] = x;
    sightings.y_m[k] = y;
    sightings.range_m[k] = std::sqrt(x * x + y * y);
    sightings.height_m[k] = static_cast<float>(flies.z_m[i] - road.z_m(x, y));
    sightings.fitness[k] = flies.fitness[i];
  }
}

}  // namespace flies
