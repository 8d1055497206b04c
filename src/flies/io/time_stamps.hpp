#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace flies {

/// Seconds since 1970, UTC: whole ones, and the rest of less than 61 apart from them, for the sum of both would round
/// to a tenth of a microsecond.
struct Moment {
  std::int64_t whole_s = 0;
  double rest_s = 0.0;
};

/// Date and time as KITTI raw writes them ("2011-09-26 13:04:32.349659964") or as RFC 3339 has them
/// ("2011-09-26T13:04:32.35+02:00", "2011-09-26T11:04:32.35Z"), also with a comma or without the colon of the time
/// zone; without a time zone in UTC.
/// @returns nothing for another text, or for what no calendar or clock shows
std::optional<Moment> parse_date_and_time(const std::string& text);

/// Reads times of pairs, one a line: seconds as a number, or date and time. Empty lines at the end are ignored.
/// @returns seconds since the first of them
/// @throws InputError naming file and line when one is neither, or time does not advance
std::vector<double> read_time_stamps(const std::string& path);

}  // namespace flies
