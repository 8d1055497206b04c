#include "flies/io/formats/named_keys.hpp"

#include <fmt/format.h>

#include <cstddef>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"

namespace flies::detail {
namespace {

/// Of two places of one thing; a matrix may stand row by row in one and column by column in the other.
bool say_the_same(const std::vector<double>& one, const std::vector<double>& other) {
  constexpr std::size_t kSide = 3;
  if (one == other) return true;
  if (one.size() != kSide * kSide || other.size() != one.size()) return false;
  for (std::size_t i = 0; i < one.size(); ++i)
    if (one[i] != other[i % kSide * kSide + i / kSide]) return false;
  return true;
}

}  // namespace

std::string plain_name(std::string_view key) {
  const auto dot = key.rfind('.');
  return plain_letters(dot == std::string_view::npos ? key : key.substr(dot + 1));
}

bool is_on_top(std::string_view key) { return key.find('.') == std::string_view::npos; }

bool is_beside(std::string_view key, std::string_view other) {
  return key.substr(0, key.rfind('.') + 1) == other.substr(0, other.rfind('.') + 1);
}

std::string chosen(const NumberTable& table, const std::vector<std::string>& keys) {
  if (keys.empty() || is_on_top(keys[0])) return keys.empty() ? "" : keys[0];
  for (const auto& key : keys)
    if (!say_the_same(table.entries.find(key)->second.numbers, table.entries.find(keys[0])->second.numbers))
      throw InputError(table.source, keys[0],
                       fmt::format("stands in the file as {} too, with other numbers: which is meant? Keep one camera "
                                   "of a rectified pair, or one pair whose keys say left and right",
                                   key));
  return keys[0];
}

}  // namespace flies::detail
