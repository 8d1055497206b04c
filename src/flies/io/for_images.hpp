#pragma once

#include "flies/io/calibration.hpp"

namespace flies::testing {

/// What a run asks for that has images of this size.
inline CalibrationRequest for_images(int width_px, int height_px) {
  CalibrationRequest request;
  request.width_px = width_px;
  request.height_px = height_px;
  return request;
}

}  // namespace flies::testing
