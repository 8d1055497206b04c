#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace flies {

/// The upper one of the two middle values of an even number of them. `values` must not be empty.
inline double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace flies
