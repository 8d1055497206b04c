#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace flies::detail {

inline std::string in_small_letters(std::string_view text) {
  std::string small;
  for (const char c : text) small += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

/// The letters and digits, small: the same for names that are spelt alike but for signs and capitals.
inline std::string plain_letters(std::string_view text) {
  std::string plain;
  for (const char c : in_small_letters(text))
    if (std::isalnum(static_cast<unsigned char>(c))) plain += c;
  return plain;
}

/// `text` without white space at its ends.
inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n\v\f";
  const auto first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

}  // namespace flies::detail
