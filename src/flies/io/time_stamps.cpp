#include "flies/io/time_stamps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <sstream>

#include "flies/core/error.hpp"
#include "flies/io/text_file.hpp"

namespace flies {
namespace {

constexpr std::size_t kMaxBytes = 64u << 20;  // two million times
constexpr double kMost_s = 1e11;              // since 1970: in the year 5138

/// How far a clock is ahead of UTC, minutes: "Z", "+01:00", "+0100", or nothing, which is UTC.
std::optional<int> parse_time_zone(const char* text) {
  if (*text == '\0' || ((*text == 'Z' || *text == 'z') && text[1] == '\0')) return 0;
  int hours = 0, minutes = 0, end = -1;
  const auto read = [&](const char* format) {
    return std::sscanf(text + 1, format, &hours, &minutes, &end) == 2 && text[1 + end] == '\0';
  };
  const bool is_offset = (*text == '+' || *text == '-') && std::isdigit(static_cast<unsigned char>(text[1])) != 0 &&
                         (read("%2d:%2d%n") || read("%2d%2d%n"));
  if (!is_offset || hours > 23 || minutes < 0 || minutes > 59) return std::nullopt;
  return (*text == '-' ? -1 : 1) * (60 * hours + minutes);
}

std::optional<Moment> parse_moment(const std::string& text) {
  if (auto moment = parse_date_and_time(text)) return moment;
  char* rest = nullptr;
  const double seconds = std::strtod(text.c_str(), &rest);
  if (text.empty() || *rest != '\0' || !(std::abs(seconds) < kMost_s)) return std::nullopt;
  const double whole = std::floor(seconds);
  return Moment{static_cast<std::int64_t>(whole), seconds - whole};
}

/// What a line that tells no moment should be.
std::string expectation(const std::string& line) {
  char* rest = nullptr;
  const double number = std::strtod(line.c_str(), &rest);
  if (*rest == '\0' && std::isfinite(number) && number >= kMost_s)
    return "is it milliseconds (microseconds, nanoseconds) since 1970? expected seconds";
  return "expected seconds, or date and time such as 2011-09-26 13:04:32.35 or 2011-09-26T13:04:32.35Z";
}

}  // namespace

std::optional<Moment> parse_date_and_time(const std::string& text) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, end = -1;
  if (std::sscanf(text.c_str(), "%4d-%2d-%2d%*1[Tt \t]%2d:%2d:%n", &year, &month, &day, &hour, &minute, &end) != 5 ||
      end <= 0)
    return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  const auto begin = static_cast<std::size_t>(end),
             zone = std::min(text.find_first_not_of("0123456789.,", begin), text.size());
  std::string seconds = text.substr(begin, zone - begin);
  std::ranges::replace(seconds, ',', '.');
  char* rest = nullptr;
  const double second_s = std::strtod(seconds.c_str(), &rest);
  const auto ahead_min = parse_time_zone(text.c_str() + zone);
  if (!date.ok() || seconds.empty() || *rest != '\0' || !ahead_min || hour < 0 || hour > 23 || minute < 0 ||
      minute > 59 || !(second_s >= 0.0 && second_s < 61.0))
    return std::nullopt;
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  return Moment{((days * 24 + hour) * 60 + minute - *ahead_min) * 60, second_s};
}

std::vector<double> read_time_stamps(const std::string& path) {
  std::istringstream lines(plain_text(read_file(path, kMaxBytes)));
  std::vector<double> times_s;
  std::optional<Moment> first;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line.resize(std::min(line.size(), line.find('#')));
    line.resize(line.find_last_not_of(" \t") + 1);
    line.erase(0, std::min(line.size(), line.find_first_not_of(" \t")));
    if (line.empty()) continue;
    const auto moment = parse_moment(line);
    if (!moment)
      throw InputError(path, fmt::format("line {}", number), fmt::format("found '{}', {}", line, expectation(line)));
    if (!first) first = moment;
    const double time_s = static_cast<double>(moment->whole_s - first->whole_s) + moment->rest_s - first->rest_s;
    if (!times_s.empty() && !(time_s > times_s.back()))
      throw InputError(path, fmt::format("line {}", number), fmt::format("found '{}', expected a later time", line));
    times_s.push_back(time_s);
  }
  if (times_s.empty()) throw InputError(path, "", "holds no times");
  return times_s;
}

}  // namespace flies
