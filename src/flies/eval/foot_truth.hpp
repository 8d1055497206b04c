#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/eval/truth.hpp"

namespace flies {

/// Reads people given by the points where they stand: lines of
/// `frame,id,left,top,width,height,considered,X,Y,Z`, frames counted from 1, the box in pixels of the rectified left
/// image and the foot point in metres of the rectified left camera (x right, y down, z forward); `#` starts a comment.
/// Every entry becomes a "Pedestrian" with a footprint of 0.5 m by 0.5 m, whose near face is the foot point, and the
/// height that its box implies; `considered` = 1 makes it `visible`.
/// @param text   the whole file
/// @param source its name, for errors
/// @param camera the rectified left camera; its mount places the vehicle frame
/// @returns frames in order, those without people included up to the last one; `frame` counts from 0
/// @throws InputError naming the line on a wrong number of fields, a field that is not a number, a frame below 1 or
///         a foot point that is not ahead of the camera
std::vector<FrameTruth> parse_foot_points(std::string_view text, const std::string& source, const StereoCamera& camera);

/// The same from a file.
/// @throws InputError also when it cannot be read
std::vector<FrameTruth> read_foot_points(const std::filesystem::path& file, const StereoCamera& camera);

}  // namespace flies
