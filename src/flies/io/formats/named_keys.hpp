#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "flies/io/number_table.hpp"

namespace flies::detail {

/// What people call one thing: small letters and digits alone. The first are looked for first.
using Names = std::initializer_list<const char*>;

/// The last part of a key, its letters and digits, small.
std::string plain_name(std::string_view key);

/// Whether a key stands below no other.
bool is_on_top(std::string_view key);

/// Whether a key stands below the same keys as another.
bool is_beside(std::string_view key, std::string_view other);

/// The keys of entries whose name is one of these, as far as `fits(key, entry)` says so: those below no other key, or
/// if there are none, all.
template <typename Fits>
std::vector<std::string> keys_of(const NumberTable& table, Names names, Fits fits) {
  std::vector<std::string> on_top, below;
  for (const std::string_view name : names)
    for (const auto& [key, entry] : table.entries)
      if (plain_name(key) == name && fits(key, entry)) (is_on_top(key) ? on_top : below).push_back(key);
  return on_top.empty() ? below : on_top;
}

/// The one of them that counts: the first below no other key, or that of which all say the same; "" when there is none.
/// @throws InputError when they say different things
std::string chosen(const NumberTable& table, const std::vector<std::string>& keys);

}  // namespace flies::detail
