#include "flies/concentrate/sightings.hpp"

#include <cmath>

namespace flies {

namespace {

/// With fitness and `in_field`, as a number: 1 or 0.
std::size_t has_say(const Population& flies, const RoadPlane& road, const FieldOptions& field, std::size_t i) {
  const double x = flies.x_m[i], y = flies.y_m[i], height_m = flies.z_m[i] - road.z_m(x, y);
  const auto between = [](double low, double value, double high) -> unsigned {
    return static_cast<unsigned>(value >= low) & static_cast<unsigned>(value <= high);
  };
  return static_cast<unsigned>(flies.fitness[i] > 0.0F) & between(field.x_min_m, x, field.x_max_m) &
         between(field.y_min_m, y, field.y_max_m) & between(field.z_min_m, height_m, field.z_max_m);
}

}  // namespace

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
  counted_.reserve(flies);
  tangent_.reserve(flies);
}

void FlySighter::sight(const Population& flies, const RoadPlane& road, const FieldOptions& field,
                       Sightings& sightings) {
  // Every fly is written, and overwritten by the next one unless it has a say: a branch would be mispredicted.
  counted_.resize(flies.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < flies.size(); ++i) {
    counted_[count] = static_cast<std::uint32_t>(i);
    count += has_say(flies, road, field, i);
  }
  counted_.resize(count);
  tangent_.resize(count);
  for (std::size_t k = 0; k < count; ++k) tangent_[k] = flies.y_m[counted_[k]] / flies.x_m[counted_[k]];

  sightings.resize(count);
  const auto from_right = order_.find(tangent_);
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = counted_[from_right[k]];
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
