#pragma once

#include <optional>
#include <string>

#include "flies/io/calibration.hpp"
#include "flies/record/ros_message.hpp"

namespace flies {

/// The calibration of a pair of cameras of ROS, read as files with the same numbers are. Of pictures that are raw it
/// has a rectifier, made of K, D, R and P; of rectified ones P counts.
/// @param request whether the pictures are raw, their size, and what the user overrules
/// @param source names the file in errors
/// @param mount of the camera, where the recording says it
/// @throws InputError when the cameras are not calibrated or no side-by-side pair, or the lens has an unknown model
Calibration ros_calibration(const RosCameraInfo& left, const RosCameraInfo& right, const CalibrationRequest& request,
                            const std::string& source, const std::optional<CameraMount>& mount = std::nullopt);

/// Whether the pictures of this camera are rectified as it gives them: no distortion, no rotation, and P is K.
bool is_rectified_by_nature(const RosCameraInfo& camera);

}  // namespace flies
