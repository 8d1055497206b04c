#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace flies {

/// The value whose rank is nearest to the share `q`, 0 to 1, of the way from the least to the largest. `values` must
/// not be empty nor hold NaN.
template <class T>
T quantile(std::vector<T> values, double q) {
  const auto at = values.begin() + std::lround(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The upper one of two middle values where their number is even.
template <class T>
T median_of(std::vector<T> values) {
  return quantile(std::move(values), 0.5);
}

}  // namespace flies
