#pragma once

#include <cmath>
#include <vector>

namespace flies::synth {

/// Places already taken, as circles on the ground.
struct Taken {
  struct Circle {
    float x, y, radius;
  };
  std::vector<Circle> circles;

  bool is_free(float x, float y, float radius) const {
    for (const auto& c : circles)
      if (std::hypot(c.x - x, c.y - y) < c.radius + radius) return false;
    return true;
  }
  /// True when none of them lies between the camera and (x, y).
  bool is_in_sight(float x, float y) const {
    for (const auto& c : circles) {
      const float along = (c.x * x + c.y * y) / (x * x + y * y);
      if (along > 0.0F && along < 1.0F && std::hypot(c.x - along * x, c.y - along * y) < c.radius) return false;
    }
    return true;
  }
  void take_car(float x, float y) {
    for (const float dx : {-1.5F, 0.0F, 1.5F}) circles.push_back({x + dx, y, 1.0F});
  }
};

}  // namespace flies::synth
