#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "flies/io/number_table.hpp"

namespace flies::detail {

/// Appends the numbers of a text such as "1 0 2; 0 1 3" or "[1, 2]"; keeps the first word that is none.
void append_words(NumberEntry& entry, std::string text);

/// Calibrations that are lines rather than a language: `P0: 1 2 3`, `cam0=[1 2; 3 4]`, sections of `fx=1` below
/// `[LEFT_CAM_HD]`, and bare rows of numbers.
/// @returns whether `text` is of such a kind, in which case `table` was filled
/// @throws InputError naming the source and a key that stands in the file twice
bool parse_lines_of_numbers(const std::string& text, NumberTable& table);

}  // namespace flies::detail
