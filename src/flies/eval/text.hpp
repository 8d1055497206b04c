#pragma once

#include <filesystem>
#include <string>
#include <string_view>

/// Reading of the small text files that truth comes in.
namespace flies::detail {

/// The whole file, which may be empty: a picture without labels, a scan without returns. @throws InputError when it
/// cannot be read
std::string read_file(const std::filesystem::path& path);

/// A finite number that fills the whole text. @throws InputError naming `source` and `field`
double parse_number(std::string_view text, const std::string& source, const std::string& field);

/// `text` without white space at its ends.
std::string_view trimmed(std::string_view text);

}  // namespace flies::detail
