#pragma once

#include <filesystem>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/eval/truth.hpp"

namespace flies {

/// Reads a disparity map as KITTI stereo 2012 and `flies synth` have them (16 bits, disparity times 256, 0 where it is
/// unknown) as points at most 60 m ahead, measured over the road that is fitted to them.
/// @throws InputError naming the file when it cannot be read, is no image of 16-bit grey or does not fit the camera
std::vector<LidarPoint> read_disparity_map(const std::filesystem::path& file, const StereoCamera& camera);

}  // namespace flies
