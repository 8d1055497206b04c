#pragma once

#include <string>
#include <vector>

namespace flies {

/// Reads times of pairs, one a line: seconds as a number, or date and time as KITTI raw writes them
/// ("2011-09-26 13:04:32.349659964"). Empty lines at the end are ignored.
/// @returns seconds since the first of them
/// @throws InputError naming file and line when one is neither, or time does not advance
std::vector<double> read_time_stamps(const std::string& path);

}  // namespace flies
