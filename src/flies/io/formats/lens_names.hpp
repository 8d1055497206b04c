#pragma once

#include <optional>
#include <string>

#include "flies/io/calibration.hpp"
#include "flies/io/lens.hpp"
#include "flies/io/number_table.hpp"

namespace flies::detail {

/// As `lens_of`; nothing when no model has that name.
std::optional<Lens> known_lens(const std::string& word);

/// The lens that a word names: "radtan", "plumb_bob", "equidistant", "kannalabrandt8", "ds", ...
/// @param key where the word stands
/// @throws InputError when no model has that name
Lens lens_of(const std::string& word, const std::string& key, const std::string& source);

/// The same of a model that a camera's own file may name beside what it does not say, or that RealSense has: nothing
/// where the word says nothing of what bends rays, as pinhole, and where none of the coefficients does.
/// @param is_bent coefficients are not all 0
/// @throws InputError when no model has that name, or RealSense's is one that is not read
std::optional<Lens> lens_of_model(const std::string& word, bool is_bent, const std::string& key,
                                  const std::string& source);

/// The lens that a file without a fixed place for it names, wherever and for whichever camera: distortion_model,
/// left.cameraModel, lens_type_1, is_fisheye: true, ... Radial and tangential where it names none.
/// @param notes on what may be the name of a model, or of a product
/// @throws InputError when it names two, an unknown one, or says of a fisheye elsewhere
Lens named_lens(const NumberTable& table, CalibrationNotes& notes);

}  // namespace flies::detail
