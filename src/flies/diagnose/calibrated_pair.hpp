#pragma once

#include <functional>
#include <string>

#include "flies/core/error.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/gray_image.hpp"

namespace flies {

/// Reads the images of a pair again, as they were before they were rectified.
using ReadPair = std::function<GrayPair()>;

/// Why images are no pair as they were rectified, though they are one: whatever else is seen in them follows from that.
class WronglyRectified : public InputError {
 public:
  using InputError::InputError;
};

/// `check_true_pair` for images that may have been rectified with the calibration. Where little of such a pair is
/// found on its rows, it is rectified otherwise: with left and right exchanged, not at all, with each other's
/// intrinsics, with R transposed. What makes a pair of the images is the fault.
/// @param pair after it was rectified, if the calibration has a rectifier
/// @param as_read called only where little is found; empty: nothing else is tried
/// @throws WronglyRectified naming both images and what makes a pair of them
/// @throws InputError as `check_true_pair` does
void check_calibrated_pair(const RectifiedPair& pair, const Calibration& calibration, const ReadPair& as_read,
                           const std::string& left_name, const std::string& right_name);

}  // namespace flies
