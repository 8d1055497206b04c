#include "flies/io/image_names.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "flies/io/folder.hpp"

namespace flies {
namespace {

using Paths = std::vector<std::string>;
using Tokens = std::vector<std::string>;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_number(const std::string& token) { return !token.empty() && is_digit(token.front()); }

/// Runs of digits, runs of letters, and every other character by itself.
Tokens tokens_of(const std::string& stem) {
  Tokens tokens;
  for (std::size_t i = 0; i < stem.size();) {
    std::size_t end = i + 1;
    if (is_digit(stem[i]))
      while (end < stem.size() && is_digit(stem[end])) ++end;
    else if (is_letter(stem[i]))
      while (end < stem.size() && is_letter(stem[end])) ++end;
    tokens.push_back(stem.substr(i, end - i));
    i = end;
  }
  return tokens;
}

/// What a name looks like, whatever its numbers and words are.
std::string shape_of(const Tokens& tokens) {
  std::string shape;
  for (const auto& token : tokens) shape += is_digit(token[0]) ? '0' : is_letter(token[0]) ? 'a' : token[0];
  return shape;
}

std::string without_zeros(const std::string& token) {
  if (!is_number(token)) return token;
  return token.substr(std::min(token.find_first_not_of('0'), token.size() - 1));
}

/// The names of a folder that look alike, as most do.
struct Names {
  std::vector<Tokens> tokens;  ///< of all
  std::string shape;           ///< of most

  explicit Names(const Paths& paths) {
    std::map<std::string, int> counts;
    for (const auto& path : paths) {
      tokens.push_back(tokens_of(detail::stem_of(path)));
      ++counts[shape_of(tokens.back())];
    }
    int most = 0;
    for (const auto& [candidate, count] : counts)
      if (count > most) {
        most = count;
        shape = candidate;
      }
  }
  bool is_usual(const Tokens& name) const { return shape_of(name) == shape; }
  /// The token at a place when all have the same there.
  std::optional<std::string> constant(std::size_t place) const {
    std::optional<std::string> found;
    for (const auto& name : tokens) {
      if (!is_usual(name)) continue;
      if (found && *found != name[place]) return std::nullopt;
      found = name[place];
    }
    return found;
  }
  /// Each name made of the tokens at these places; those that look otherwise remain whole.
  Paths kept(const std::vector<std::size_t>& places) const {
    Paths names;
    for (const auto& name : tokens) {
      std::string text;
      if (is_usual(name)) {
        for (const std::size_t place : places) text += without_zeros(name[place]);
      } else {
        for (const auto& token : name) text += token;
      }
      names.push_back(std::move(text));
    }
    return names;
  }
};

std::vector<std::size_t> varying_places(const Names& names) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < names.shape.size(); ++i)
    if (!names.constant(i)) places.push_back(i);
  return places;
}

bool tell_images_apart(const Paths& names) {
  const auto says_something = [](const std::string& name) {
    return std::any_of(name.begin(), name.end(), [](char c) { return is_digit(c) || is_letter(c); });
  };
  return std::set<std::string>(names.begin(), names.end()).size() == names.size() &&
         std::all_of(names.begin(), names.end(), says_something);
}

double number_of(const std::string& digits) {
  double number = 0.0;
  std::from_chars(digits.data(), digits.data() + digits.size(), number, std::chars_format::fixed);
  return number;
}

std::optional<double> date_and_time_of(const std::string& stem) {
  static const std::regex kSpoken(
      R"((?:^|\D)(\d{4})[-_.](\d{2})[-_.](\d{2})[T _-]+(\d{2})[-_:.](\d{2})[-_:.](\d{2})(?:[.,_-](\d{1,9}))?(?!\d))");
  static const std::regex kCompact(
      R"((?:^|\D)(\d{4})(\d{2})(\d{2})[T_-](\d{2})(\d{2})(\d{2})(?:[.,_-]?(\d{1,9}))?(?!\d))");
  // Of other years it is a count of micro- or nanoseconds.
  static const std::regex kRun(
      R"((?:^|\D)(199\d|20\d\d|2100)(\d{2})(\d{2})(\d{2})(\d{2})(\d{2})(?:[.,_-]?(\d{1,9}))?(?!\d))");
  std::smatch found;
  if (!std::regex_search(stem, found, kSpoken) && !std::regex_search(stem, found, kCompact) &&
      !std::regex_search(stem, found, kRun))
    return std::nullopt;
  const auto part = [&](std::size_t i) { return std::stoi(found[i].str()); };
  const std::chrono::year_month_day date{std::chrono::year(part(1)), std::chrono::month(static_cast<unsigned>(part(2))),
                                         std::chrono::day(static_cast<unsigned>(part(3)))};
  if (!date.ok() || part(4) > 23 || part(5) > 59 || part(6) > 60) return std::nullopt;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  const double whole_s = ((static_cast<double>(days) * 24 + part(4)) * 60 + part(5)) * 60 + part(6);
  return whole_s + (found[7].matched ? number_of("0." + found[7].str()) : 0.0);
}

/// @param is_even whether all names of the folder have as many digits after the seconds: then they are a fraction
std::optional<double> seconds_of(const std::string& stem, bool is_even) {
  static const std::regex kFraction(R"((?:^|\D)(\d{9,}\.\d+)(?!\d))");
  static const std::regex kShortFraction(R"([A-Za-z_-]*?(\d+\.\d+)[A-Za-z_-]*)");
  static const std::regex kNanoseconds(R"((?:^|\D)([1-9]\d{9})[_-](\d{1,9})(?!\d))");
  static const std::regex kOne(R"((?:^|\D)([1-9]\d{9,18})(?!\d))");
  std::smatch found;
  if (std::regex_search(stem, found, kFraction) || std::regex_match(stem, found, kShortFraction))
    return number_of(found[1].str());
  if (std::regex_search(stem, found, kNanoseconds)) {
    const std::string rest = found[2].str();
    return number_of(found[1].str()) + (is_even ? number_of("0." + rest) : 1e-9 * number_of(rest));
  }
  if (!std::regex_search(stem, found, kOne)) return std::nullopt;
  const std::string digits = found[1].str();
  const double unit_s = digits.size() == 10 ? 1.0 : digits.size() == 13 ? 1e-3 : digits.size() == 16 ? 1e-6 : 1e-9;
  return number_of(digits) * unit_s;
}

}  // namespace

std::optional<std::vector<double>> times_in_names(const Paths& paths) {
  std::vector<std::string> stems;
  std::set<std::size_t> lengths;
  for (const auto& path : paths) {
    stems.push_back(detail::stem_of(path));
    lengths.insert(stems.back().size());
  }
  std::vector<double> times_s;
  for (const auto& stem : stems) {
    auto time_s = date_and_time_of(stem);
    if (!time_s) time_s = seconds_of(stem, lengths.size() == 1);
    if (!time_s) return std::nullopt;
    times_s.push_back(*time_s);
  }
  return times_s;
}

std::optional<std::vector<std::int64_t>> numbers_in_names(const Paths& paths) {
  const Names names(paths);
  std::optional<std::size_t> last;
  for (const std::size_t place : varying_places(names))
    if (names.shape[place] == '0') last = place;
  if (paths.size() == 1 && !last)
    if (const auto at = names.shape.rfind('0'); at != std::string::npos) last = at;
  if (!last) return std::nullopt;
  std::vector<std::int64_t> numbers;
  for (const auto& name : names.tokens) {
    if (!names.is_usual(name)) return std::nullopt;
    const std::string& digits = name[*last];
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc{} || (!numbers.empty() && number <= numbers.back())) return std::nullopt;
    numbers.push_back(number);
  }
  return numbers;
}

std::pair<Paths, Paths> names_without_side(const Paths& left, const Paths& right) {
  const Names left_names(left), right_names(right);
  auto left_places = varying_places(left_names), right_places = varying_places(right_names);
  if (left_names.shape == right_names.shape) {
    left_places.clear();
    for (std::size_t i = 0; i < left_names.shape.size(); ++i) {
      const auto of_left = left_names.constant(i), of_right = right_names.constant(i);
      const bool is_side = of_left && of_right && *of_left != *of_right;
      if (!is_side) left_places.push_back(i);
    }
    right_places = left_places;
  }
  if (left_places.size() == right_places.size()) {
    auto left_kept = left_names.kept(left_places), right_kept = right_names.kept(right_places);
    if (tell_images_apart(left_kept) && tell_images_apart(right_kept))
      return {std::move(left_kept), std::move(right_kept)};
  }
  const auto stems_of = [](const Paths& paths) {
    Paths stems;
    for (const auto& path : paths) stems.push_back(detail::stem_of(path));
    return stems;
  };
  return {stems_of(left), stems_of(right)};
}

}  // namespace flies
