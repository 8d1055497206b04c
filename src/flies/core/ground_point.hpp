#pragma once

namespace flies {

/// A point on the ground of the vehicle frame.
struct GroundPoint {
  double x_m = 0.0;
  double y_m = 0.0;
};

}  // namespace flies
