#pragma once

#include <string>

#include "flies/synth/truth.hpp"

/// Writes KITTI's disparity map: 16 bits, disparity times 256, 0 where there is none.
/// @throws flies::InputError naming the file when it cannot be written
void write_disparity_png(const std::string& path, const flies::PixelTruth& truth);
