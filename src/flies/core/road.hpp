#pragma once

namespace flies {

/// The road ahead as a plane in the vehicle frame: z = height + slope * x + bank * y. All zero on the nominal ground.
/// It absorbs what the calibration does not know: braking and load tilt the camera, roads rise and fall.
struct RoadPlane {
  double height_m = 0.0;  ///< at the origin
  double slope = 0.0;     ///< rise per metre forward
  double bank = 0.0;      ///< rise per metre to the left

  double z_m(double x_m, double y_m) const { return height_m + slope * x_m + bank * y_m; }
};

}  // namespace flies
