#pragma once

#include <string>

namespace flies::detail {

/// Whether names are alike but for left and right, l and r, or numbers of which the second are the next, as infra1 and
/// infra2. Case does not count.
bool is_left_and_right(const std::string& left, const std::string& right);

}  // namespace flies::detail
