#pragma once

#include <algorithm>

namespace flies {

/// Where the parabola through three equidistant values peaks, in steps from the middle one, -1..1; 0 when it has no
/// peak. Between -0.5 and 0.5 when the middle value is the largest.
inline double parabola_vertex(double before, double middle, double after) {
  const double curvature = before - 2.0 * middle + after;
  return curvature < 0.0 ? std::clamp(0.5 * (before - after) / curvature, -1.0, 1.0) : 0.0;
}

}  // namespace flies
