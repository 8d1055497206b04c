#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "flies/eval/truth.hpp"

namespace flies {

/// Reads the truth of one pair in our own format, which synthetic scenes come in (docs/evaluation.md): `{"objects":
/// [{"class", "x_m", "y_m", "length_m", "width_m", "height_m", and optionally "z_m", "yaw_rad", "truncation",
/// "occlusion", "visible_px"}, ...]}`, positions in the vehicle frame, further keys ignored. Any program may write it.
/// Classes keep their name with a capital. Everything but walls and hedges, which reach along the street, is `visible`
/// when less than half of it is hidden, at most half lies outside the image and 100 pixels show it.
/// @param source file name for errors
/// @throws InputError naming the object and the key on malformed JSON, a missing key, or a value of another type
FrameTruth parse_scene_truth(std::string_view text, const std::string& source);

/// The same from a file; its stem becomes the frame's name.
/// @throws InputError also when it cannot be read
FrameTruth read_scene_truth(const std::filesystem::path& file);

}  // namespace flies
