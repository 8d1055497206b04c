#pragma once

#include <optional>
#include <string>

#include "flies/io/lens.hpp"
#include "flies/io/number_table.hpp"

namespace flies::detail {

/// As `lens_of`; nothing when no model has that name.
std::optional<Lens> known_lens(const std::string& word);

/// The lens that a word names: "radtan", "plumb_bob", "equidistant", "kannalabrandt8", "ds", ...
/// @param key where the word stands
/// @throws InputError when no model has that name
Lens lens_of(const std::string& word, const std::string& key, const std::string& source);

/// The lens that a file without a fixed place for it names, wherever and for whichever camera: distortion_model,
/// left.cameraModel, lens_type_1, is_fisheye: true, ... Radial and tangential where it names none.
/// @throws InputError when it names two, an unknown one, or says of a fisheye elsewhere
Lens named_lens(const NumberTable& table);

}  // namespace flies::detail
