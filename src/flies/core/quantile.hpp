#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
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

/// The same without a copy, for the hot path: the rank is rounded down, and `values` are left in another order.
template <class T>
T lower_quantile(std::vector<T>& values, double q) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The middle of the values, the upper of the two middle ones of an even number: one of the values, as an estimate on
/// the hot path wants it.
template <class T>
T upper_median(std::vector<T> values) {
  return quantile(std::move(values), 0.5);
}

/// The median of statistics: the middle of the values, the mean of the two middle ones of an even number; nothing
/// without values. What is published is this one.
inline std::optional<double> median(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace flies
