#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace flies {

/// Seconds that the names of a folder's images tell: date and time (2024-05-01T10-00-00.100, 20240501_100000,
/// 20240501100000123), seconds with a fraction (1698765432.1039), seconds and nanoseconds (1698765432_103900000), or
/// one number of at least ten digits, which counts seconds (10 digits), milliseconds (13), microseconds (16) or
/// nanoseconds. Words before and after are passed over, and numbers that begin with 0 are counters.
/// @returns nothing when one of the names tells none
std::optional<std::vector<double>> times_in_names(const std::vector<std::string>& paths);

/// The last number in each name among those that are not the same in all of them: frame_0012_cam0 is 12.
/// @returns nothing when they do not ascend
std::optional<std::vector<std::int64_t>> numbers_in_names(const std::vector<std::string>& paths);

/// Names of the images of two folders without what is constant in each and differs between the two (0004_L and 0004_R,
/// img_0001_0 and img_0001_1), numbers without their leading zeros. Where that would make two images of a folder one,
/// names are left whole.
std::pair<std::vector<std::string>, std::vector<std::string>> names_without_side(const std::vector<std::string>& left,
                                                                                 const std::vector<std::string>& right);

}  // namespace flies
