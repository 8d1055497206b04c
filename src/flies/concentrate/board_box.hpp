#pragma once

#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// An upright board at one range, between two bearings, from the road up to its height.
struct UprightBoard {
  double range_m = 0.0;
  double right_rad = 0.0, left_rad = 0.0;
  double height_m = 0.0;
};

/// The box in the left image around the four corners of the board: a camera that leans shows them askew. A corner that
/// the tilt puts behind the camera is moved just before it, so that the box is finite.
ImageBox board_box(const UprightBoard& board, const Projection& projection, const RoadPlane& road);

}  // namespace flies
