#pragma once

#include <string>

#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {

/// @throws InputError when a matrix, the distortion or the pose cannot be, or the lenses differ
void check_raw_pair(const RawPair& pair, const std::string& source);

/// What a camera says that a lens of the radial and tangential model hardly can: a file that does not name the model of
/// a fisheye's four coefficients, or another order of the coefficients. Empty when there is nothing to say.
std::string note_on_lens(const RawCamera& camera, const std::string& key, int width_px, int height_px);

/// That coefficients of the radial and tangential model bend rays back towards the middle well within the image, as
/// those of no lens do; empty when they do not.
std::string note_on_fold(const RawCamera& camera, const std::string& key, int width_px, int height_px);

/// That axes of pixels which do not stand upright on each other are taken as if they did; empty when they do.
std::string note_on_skew(const RawCamera& camera, const std::string& key);

}  // namespace flies::detail
