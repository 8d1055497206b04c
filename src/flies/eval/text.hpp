#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Reading of the small text files that truth comes in.
namespace flies::detail {

/// The bytes of a file of truth, which may be empty. @throws InputError when it cannot be read or has more than 1 GiB
std::string read_truth(const std::filesystem::path& path);

/// Labels hold metres, pixels and counts of frames. Larger numbers are damage, and would overflow what is computed from
/// them.
inline constexpr double kMaxNumber = 1e9;

/// A number within +-`kMaxNumber` that fills the whole text. @throws InputError naming `source` and `field`
double parse_number(std::string_view text, const std::string& source, const std::string& field);

/// The same without a fraction.
int parse_whole_number(std::string_view text, const std::string& source, const std::string& field);

/// @throws InputError naming `source` and `field` unless the value is within +-`kMaxNumber`
void check_number(double value, const std::string& source, const std::string& field);

/// A line that says something.
struct TextLine {
  int number = 0;       ///< in the file, from 1
  std::string content;  ///< without white space at its ends
};

/// The lines of a text of any encoding that `plain_text` knows, without blank ones and those that begin with '#'.
std::vector<TextLine> lines_of(std::string_view text);

}  // namespace flies::detail
