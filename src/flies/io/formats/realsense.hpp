#pragma once

#include <string>

#include "flies/io/number_table.hpp"

namespace flies::detail {

/// What `rs-enumerate-devices -c` prints: a block for each stream and size, one for each pose.
/// @returns whether `text` is of that kind, in which case `table` was filled
/// @throws InputError when a block stands in it twice with other numbers, as those of two cameras
bool parse_realsense(const std::string& text, NumberTable& table);

}  // namespace flies::detail
