#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "flies/eval/truth.hpp"

namespace flies {

/// What the truth of a pair is read for: each pair by itself, or objects and vehicle followed from pair to pair.
enum class SceneUse { alone, in_sequence };

/// Reads the truth of one pair in our own format, which synthetic scenes come in (docs/evaluation.md): `{"objects":
/// [{"class", "x_m", "y_m", "length_m", "width_m", "height_m", and optionally "z_m", "yaw_rad", "truncation",
/// "occlusion", "visible_px", "id"}, ...]}`, positions in the vehicle frame, further keys ignored. Any program may
/// write it. In a sequence "time_s" and "pose" are needed as well, and an "id" of its own for every object. Classes
/// keep their name with a capital. Everything but walls and hedges, which reach along the street, is `visible` when
/// less than half of it is hidden, at most half lies outside the image and 100 pixels show it.
/// @param source file name for errors
/// @throws InputError naming the object and the key on malformed JSON, a missing key, a value of another type or one
///         that cannot be: a size or a number of pixels below 0, a share outside 0 to 1, an id that is no whole number
///         from 0 or, in a sequence, another object's
FrameTruth parse_scene_truth(std::string_view text, const std::string& source, SceneUse use = SceneUse::alone);

/// The same from a file; its stem becomes the frame's name.
/// @throws InputError also when it cannot be read
FrameTruth read_scene_truth(const std::filesystem::path& file, SceneUse use = SceneUse::alone);

}  // namespace flies
