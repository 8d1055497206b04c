#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "flies/classify/people_model.hpp"

namespace flies {

/// Larger files are no models.
inline constexpr std::size_t kMaxModelFile_bytes = std::size_t{1} << 28;

/// Reads a model file (docs/formats.md).
/// @throws InputError naming the file and the field: unreadable, not JSON, another format or version, missing or
///         unknown key, wrong type, wrong length, a number that is not finite, a checksum that does not fit
PeopleModel read_people_model(const std::string& path);

/// The default of the models that come with the library: models/people_48x96_network.json.
PeopleModel shipped_people_model();

/// The same from text in memory.
/// @param source names it in errors
PeopleModel parse_people_model(std::string_view text, const std::string& source);

/// The same without the checksum, which takes a third of the time and is of no use in text that was linked in.
PeopleModel parse_embedded_model(std::string_view text, const std::string& source);

/// Writes a model file, whole or not at all. The same model gives the same bytes, and reads back to the same values.
/// @throws InputError naming the file when it cannot be written, or a field of the model that is inconsistent
void write_people_model(const std::string& path, const PeopleModel& model);

/// Checks that a model file can hold the text as its name or about it.
/// @throws InputError naming source and field when it is not UTF-8
void check_model_text(const std::string& text, const std::string& source, const std::string& field);

/// The text of a model file. @throws InputError as `write_people_model`
std::string people_model_text(const PeopleModel& model);

/// Rounds all numbers to what fits 16 bits (IEEE 754 binary16), which the file then stores in half the space.
/// Do this before the model is evaluated, so that what is measured is what is shipped.
void round_to_half(std::vector<float>& values);

}  // namespace flies
