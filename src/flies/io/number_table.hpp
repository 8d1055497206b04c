#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace flies {

/// The numbers behind one key of a calibration file.
struct NumberEntry {
  std::vector<double> numbers;
  std::string not_a_number;  ///< first word that is not a number, empty when all are; only a fault when it is asked for
};

/// The key of numbers that stand in a file without any.
inline constexpr const char* kBareNumbers = "numbers";

/// A calibration file of any syntax, flattened: keys ("P2", "left.projection_matrix", "cameraData.0.1.width": lists of
/// maps count their items) and their numbers, row by row. Every calibration format is a reader of this one table.
struct NumberTable {
  std::string source;  ///< file name, for errors
  std::map<std::string, NumberEntry, std::less<>> entries;
  bool is_cut_off = false;  ///< the last of its messages lacks its end, and is left out

  bool has(std::string_view key) const { return entries.find(key) != entries.end(); }

  /// The numbers of `key`, all finite.
  /// @throws InputError naming source and key when it is missing, has another count, or holds words, NaN or infinity
  const std::vector<double>& require(std::string_view key, std::size_t count) const;
  const std::vector<double>& require(std::string_view key) const;  ///< any count but 0
  double require_number(std::string_view key) const { return require(key, 1)[0]; }
  /// A whole number of pixels, 1..100000.
  int require_size(std::string_view key) const;
  /// The first word of `key`, in small letters; "" when it is missing or a number.
  std::string word(std::string_view key) const;
};

/// " (...)" on commas that were meant as decimal points, each of which makes two whole numbers of one; "" when there
/// are not too many numbers, or not such ones.
std::string hint_of_decimal_commas(const std::vector<double>& numbers, std::size_t expected);

/// Reads a calibration file of any understood syntax: `key: numbers` lines, `key=[...]` lines,
/// sections of `key=number` lines, bare numbers, YAML, JSON, OpenCV XML.
/// @throws InputError when the file cannot be read or its YAML or XML is malformed
NumberTable read_number_table(const std::string& path);

/// The same from text; `source` names it in errors.
NumberTable parse_number_table(const std::string& text, const std::string& source);

}  // namespace flies
