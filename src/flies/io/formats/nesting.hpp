#pragma once

#include <string>
#include <string_view>

#include "flies/io/number_table.hpp"

namespace flies::detail {

/// What stands below a key, such as "stereo.": the entries whose keys begin with it, without it.
inline NumberTable below(const NumberTable& table, std::string_view prefix) {
  NumberTable inner{table.source, {}};
  for (const auto& [key, entry] : table.entries)
    if (key.starts_with(prefix)) inner.entries.emplace(key.substr(prefix.size()), entry);
  return inner;
}

}  // namespace flies::detail
