#pragma once

#include <string>

namespace flies::detail {

/// Files that are close to a calibration, or kept beside one, and none.
/// @throws InputError saying what `bytes` are, and what to give instead
void check_no_foreign_file(const std::string& bytes, const std::string& path);

}  // namespace flies::detail
