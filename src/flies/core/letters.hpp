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

}  // namespace flies::detail
