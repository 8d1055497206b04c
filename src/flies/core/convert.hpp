#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <optional>

/// From floating point to whole numbers: what a cast leaves undefined when the value does not fit is defined here.
namespace flies {

/// The value as a whole number; nothing when it has a fraction, is not finite or does not fit.
template <std::integral Int>
std::optional<Int> whole_number(double value) {
  // The limits as powers of two are exact, whatever the width of Int: the highest is one above its maximum.
  constexpr double kEnd = static_cast<double>(std::numeric_limits<Int>::max() / 2 + 1) * 2.0;
  constexpr auto kLowest = static_cast<double>(std::numeric_limits<Int>::min());
  if (!(value >= kLowest && value < kEnd) || value != std::trunc(value)) return std::nullopt;
  return static_cast<Int>(value);
}

/// The value without its fraction, or the nearest number there is; 0 when it is not a number.
template <std::integral Int>
Int saturated(double value) {
  constexpr double kEnd = static_cast<double>(std::numeric_limits<Int>::max() / 2 + 1) * 2.0;
  constexpr auto kLowest = static_cast<double>(std::numeric_limits<Int>::min());
  if (std::isnan(value)) return 0;
  if (value <= kLowest) return std::numeric_limits<Int>::min();
  if (value >= kEnd) return std::numeric_limits<Int>::max();
  return static_cast<Int>(value);
}

}  // namespace flies
