#pragma once

#include <cstddef>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// A region of interest: where in the left image a person of this height would stand at this place.
/// The box has the detector's aspect 1:2 with its margin around the person (METHOD section 5).
struct Roi {
  ImageBox window;             ///< what the classifier looks at, aspect 48:96; may reach beyond the image
  ImageBox person;             ///< head to feet inside the window
  double x_m = 0.0;            ///< foot point on the road, vehicle frame
  double y_m = 0.0;
  double height_m = 0.0;       ///< assumed height of the person
  std::size_t obstacle = 0;    ///< index of the obstacle it was proposed for
};

}  // namespace flies
