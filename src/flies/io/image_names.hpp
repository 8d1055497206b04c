#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace flies {

/// Seconds that the names of a folder's images tell: date and time (2024-05-01T10-00-00.100, 01-05-2024_10-00-00.100
/// with the day first, 20240501_100000, 20240501100000123), seconds with a fraction (1698765432.1039), seconds and
/// nanoseconds (1698765432_103900000), one number of at least ten digits, which counts seconds (10 digits),
/// milliseconds (13), microseconds (16) or nanoseconds, or the time of day with milli- or microseconds (10-00-00.100),
/// where it ascends. Words before and after are passed over, and numbers that begin with 0 are counters.
/// @returns nothing when one of the names tells none
std::optional<std::vector<double>> times_in_names(const std::vector<std::string>& paths);

/// The last number in each name among those that are not the same in all of them: frame_0012_cam0 is 12.
/// @returns nothing when they do not ascend
std::optional<std::vector<std::int64_t>> numbers_in_names(const std::vector<std::string>& paths);

/// The number that ascends in all names and does so in the largest steps: 0012_83211 is 83211, not the 12th.
/// @returns nothing when none ascends
std::optional<std::vector<std::int64_t>> finest_numbers_in_names(const std::vector<std::string>& paths);

/// The left and the right images of a folder that holds both, by what all of its names say: left or right, l or r, in
/// capitals or not, or a number that is 0 or 1 (1 or 2) beside another one (cam0_0007, 0007_1).
/// @returns nothing when they do not say it
std::optional<std::pair<std::vector<std::string>, std::vector<std::string>>> sides_in_names(
    const std::vector<std::string>& paths);

/// Names of the images of two folders without what is constant in each and differs between the two (0004_L and 0004_R,
/// img_0001_0 and img_0001_1), numbers without their leading zeros. Where that would make two images of a folder one,
/// names are left whole.
std::pair<std::vector<std::string>, std::vector<std::string>> names_without_side(const std::vector<std::string>& left,
                                                                                 const std::vector<std::string>& right);

}  // namespace flies
