#include "channels/picture_times.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "flies/io/time_stamps.hpp"

namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kSecond_ns = 1'000'000'000U;
constexpr std::uint64_t kMost_s = 10'000'000'000U;  // beyond it nanoseconds leave 64 bits

/// Behind the quotes that end the text that begins at `start`, or the end.
std::size_t end_of_text(std::string_view json, std::size_t start) {
  for (std::size_t at = json.find('"', start + 1); at != json.npos; at = json.find('"', at + 1)) {
    const std::size_t last = json.find_last_not_of('\\', at - 1);
    if ((at - last) % 2 == 1) return at + 1;  // no backslashes, or pairs of them
  }
  return json.size();
}

/// Behind the value that begins at `start`, or the end.
std::size_t end_of_value(std::string_view json, std::size_t start) {
  int depth = 0;
  for (std::size_t at = start; at < json.size();) {
    const char c = json[at];
    if (c == '"') {
      at = end_of_text(json, at);
      continue;
    }
    if (depth == 0 && (c == ',' || c == '}' || c == ']')) return at;
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    ++at;
  }
  return json.size();
}

/// A member of the outermost object; empty where it has none of this name.
std::string_view member(std::string_view json, std::string_view name) {
  constexpr std::string_view kBlank = " \t\r\n";
  std::size_t at = json.find('{');
  while (at != json.npos && at < json.size() && json[at] != '}') {
    const std::size_t key = json.find_first_not_of(kBlank, at + 1);
    if (key == json.npos || json[key] != '"') return {};
    const std::size_t key_end = end_of_text(json, key), colon = json.find_first_not_of(kBlank, key_end);
    if (colon == json.npos || json[colon] != ':') return {};
    const std::size_t end = end_of_value(json, colon + 1);
    if (json.substr(key + 1, key_end - key - 2) == name) return json.substr(colon + 1, end - colon - 1);
    at = end;
  }
  return {};
}

/// A whole number that is not negative, be it in quotes or with a decimal point.
std::optional<std::uint64_t> whole_number(const Json& json) {
  if (json.is_number_unsigned()) return json.get<std::uint64_t>();
  if (json.is_number_float()) {
    constexpr double kMost = 1e18;
    const double number = json.get<double>();
    if (!(number >= 0.0 && number < kMost) || number != std::floor(number)) return std::nullopt;
    return static_cast<std::uint64_t>(number);
  }
  if (!json.is_string()) return std::nullopt;
  const auto& text = json.get_ref<const std::string&>();
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

/// The part of a stamp that is called by one of these names; 0 where none is there.
std::optional<std::uint64_t> part(const Json& stamp, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const auto found = stamp.find(name); found != stamp.end()) return whole_number(*found);
  return 0;
}

std::optional<std::uint64_t> stamp_of_parts(const Json& stamp) {
  const auto seconds = part(stamp, {"sec", "secs", "seconds"});
  const auto rest_ns = part(stamp, {"nsec", "nsecs", "nanosec", "nanos", "nanoseconds"});
  if (!seconds || !rest_ns || *seconds > kMost_s || *rest_ns >= kSecond_ns) return std::nullopt;
  return *seconds * kSecond_ns + *rest_ns;
}

std::optional<std::uint64_t> stamp_of_text(const std::string& text) {
  constexpr std::size_t kDate = 10;  // letters, behind which a sign is that of a time zone
  const auto moment = flies::parse_date_and_time(text);
  if (!moment || text.find_last_of("Zz+-") < kDate) return std::nullopt;
  if (moment->whole_s < 0 || static_cast<std::uint64_t>(moment->whole_s) > kMost_s) return std::nullopt;
  return static_cast<std::uint64_t>(moment->whole_s) * kSecond_ns +
         static_cast<std::uint64_t>(std::llround(1e9 * moment->rest_s));
}

}  // namespace

std::optional<std::uint64_t> json_stamp_ns(std::string_view message) {
  const std::string_view text = member(message, "timestamp");
  if (text.empty()) return 0;
  const Json stamp = Json::parse(text, nullptr, false);
  if (stamp.is_null()) return 0;
  if (stamp.is_object()) return stamp_of_parts(stamp);
  return stamp.is_string() ? stamp_of_text(stamp.get_ref<const std::string&>()) : std::nullopt;
}

std::vector<std::uint64_t> times_on_one_clock(const std::vector<PictureTimes>& pictures) {
  std::map<std::uint64_t, std::uint64_t> stamps_ns;  // by when they were recorded
  for (const auto& [stamp_ns, recorded_ns] : pictures)
    if (stamp_ns != 0) stamps_ns[recorded_ns] = stamp_ns;
  std::vector<std::uint64_t> times_ns;
  for (const auto& [stamp_ns, recorded_ns] : pictures) {
    if (stamp_ns != 0 || stamps_ns.empty()) {
      times_ns.push_back(stamp_ns == 0 ? recorded_ns : stamp_ns);
      continue;
    }
    const auto& [neighbour_recorded_ns, neighbour_ns] = *nearest(stamps_ns, recorded_ns);
    const std::uint64_t time_ns = neighbour_ns + recorded_ns - neighbour_recorded_ns;  // which may wrap and wrap back
    const bool is_before_all =
        recorded_ns < neighbour_recorded_ns && neighbour_recorded_ns - recorded_ns > neighbour_ns;
    times_ns.push_back(is_before_all ? 0 : time_ns);
  }
  return times_ns;
}

std::optional<std::vector<std::int64_t>> multiples_of_usual(const std::vector<std::uint64_t>& distances_ns) {
  constexpr double kJitter = 0.3, kDrift = 0.01;
  if (distances_ns.empty()) return std::nullopt;
  std::vector<std::uint64_t> sorted_ns = distances_ns;
  std::ranges::sort(sorted_ns);
  const auto usual_ns = static_cast<double>(sorted_ns[(sorted_ns.size() - 1) / 2]);
  std::vector<std::int64_t> steps;
  for (const std::uint64_t distance_ns : distances_ns) {
    const double times = static_cast<double>(distance_ns) / usual_ns, step = std::round(times);
    if (step < 1.0 || std::abs(times - step) > std::max(kJitter, kDrift * step)) return std::nullopt;
    steps.push_back(static_cast<std::int64_t>(step));
  }
  return steps;
}
