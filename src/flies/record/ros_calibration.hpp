#pragma once

#include <string>

#include "flies/io/calibration.hpp"
#include "flies/record/ros_message.hpp"

namespace flies {

/// The calibration of a pair of cameras of ROS. Of pictures that are not rectified it has a rectifier, made of K, D and
/// R; of rectified ones the projections P count.
/// @param is_rectified the pictures are those of image_rect, or both cameras have neither distortion nor rotation
/// @param source names the file in errors
/// @throws InputError when P, K or D give no side-by-side stereo camera, or the distortion has an unknown model
Calibration ros_calibration(const RosCameraInfo& left, const RosCameraInfo& right, bool is_rectified,
                            const std::string& source);

/// Whether pictures of this camera are rectified as they are: no distortion, no rotation.
bool is_rectified_by_nature(const RosCameraInfo& camera);

}  // namespace flies
