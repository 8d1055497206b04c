#pragma once

#include <span>
#include <string>
#include <string_view>

namespace flies {

/// "; did you mean 'NAME'?" with the name among `known` that is fewest edits away; empty when none is near.
/// @param quote round the name
std::string did_you_mean(std::string_view name, std::span<const std::string> known, std::string_view quote = "'");

}  // namespace flies
