#pragma once

#include <optional>

namespace flies {

/// The oriented rectangle that an object covers on the ground of the vehicle frame.
struct Footprint {
  double x_m = 0.0;  ///< centre
  double y_m = 0.0;
  double yaw_rad = 0.0;   ///< of its length against the x axis, positive to the left
  double length_m = 0.0;  ///< along its heading
  double width_m = 0.0;
};

/// Horizontal distance from a point to the rectangle, metres; 0 inside.
double distance_to_footprint_m(const Footprint& footprint, double x_m, double y_m);

/// Range of the nearest point of the rectangle, metres from the origin of the vehicle frame.
double near_range_m(const Footprint& footprint);

/// Range at which the ray from the origin at this azimuth enters the rectangle: its near face in that direction.
/// @param azimuth_rad atan2(y, x)
/// @returns nothing when the ray passes beside it, 0 when the origin lies inside
std::optional<double> near_face_range_m(const Footprint& footprint, double azimuth_rad);

/// Extent of the rectangle across the line of sight to its centre, metres: the width a camera sees.
double seen_width_m(const Footprint& footprint);

/// Extent of those faces of the rectangle that are turned to the origin, along the line of sight to its centre, metres:
/// the depth a camera can see. 0 for one face straight across it.
double seen_depth_m(const Footprint& footprint);

}  // namespace flies
