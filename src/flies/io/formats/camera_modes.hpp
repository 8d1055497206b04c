#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "flies/io/calibration.hpp"

namespace flies::detail {

/// A size of images that a camera delivers, and its numbers in the file for them.
struct CameraMode {
  int width_px = 0, height_px = 0;
  double focal_px = 0.0;  ///< of the left camera: modes of one shape may see more or less to the side
};

struct ChosenMode {
  std::size_t index = 0;
  CalibrationNotes notes = {};  ///< that images may be of another mode, by which ranges would differ
};

/// Which of the modes that a file has numbers for the images are of: the one that the user says, that of their size, or
/// one that they were resized from by one scale, of several the one that they are the half or another whole fraction
/// of; the first when no size is asked for.
/// @throws InputError naming the modes when it is none of them
ChosenMode choose_mode(const std::vector<CameraMode>& modes, const CalibrationRequest& request,
                       const std::string& source);

}  // namespace flies::detail
