#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "flies/core/quantile.hpp"

namespace flies {

/// Red, green, blue.
using Rgb = std::array<std::uint8_t, 3>;

/// The colour of a fly: blue for 0, over cyan, green and yellow, to red for 1 and more (figure 2 of the paper).
inline Rgb fitness_color(double relative_fitness) {
  const double t = std::isfinite(relative_fitness) ? std::clamp(relative_fitness, 0.0, 1.0) : 0.0;
  const auto level = [](double value) {
    return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
  };
  return {level(4.0 * t - 2.0), level(2.0 - std::abs(4.0 * t - 2.0)), level(2.0 - 4.0 * t)};
}

/// The fitness drawn red: exceeded by one fly in a hundred, so that a few giants (Eq. (2) has no upper bound) do not
/// leave all others blue. 0 when there are no flies.
inline float full_scale_fitness(std::span<const float> fitness) {
  std::vector<float> finite;
  std::copy_if(fitness.begin(), fitness.end(), std::back_inserter(finite), [](float f) { return std::isfinite(f); });
  if (finite.empty()) return 0.0F;
  return quantile(std::move(finite), 0.99);
}

}  // namespace flies
