#include "flies/io/image_names.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <string_view>

#include "flies/core/letters.hpp"
#include "flies/io/folder.hpp"

namespace flies {
namespace {

using Paths = std::vector<std::string>;
using Tokens = std::vector<std::string>;

Paths stems_of(const Paths& paths) {
  Paths stems;
  for (const auto& path : paths) stems.push_back(detail::stem_of(path));
  return stems;
}

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
    return std::ranges::any_of(name, [](char c) { return is_digit(c) || is_letter(c); });
  };
  return std::set<std::string>(names.begin(), names.end()).size() == names.size() &&
         std::ranges::all_of(names, says_something);
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
  static const std::regex kDayFirst(
      R"((?:^|\D)(\d{2})[-_.](\d{2})[-_.](\d{4})[T _-]+(\d{2})[-_:.](\d{2})[-_:.](\d{2})(?:[.,_-](\d{1,9}))?(?!\d))");
  std::smatch found;
  const bool is_year_first = std::regex_search(stem, found, kSpoken) || std::regex_search(stem, found, kCompact) ||
                             std::regex_search(stem, found, kRun);
  if (!is_year_first && !std::regex_search(stem, found, kDayFirst)) return std::nullopt;
  const auto part = [&](std::size_t i) { return std::stoi(found[i].str()); };
  const std::chrono::year_month_day date{std::chrono::year(part(is_year_first ? 1 : 3)),
                                         std::chrono::month(static_cast<unsigned>(part(2))),
                                         std::chrono::day(static_cast<unsigned>(part(is_year_first ? 3 : 1)))};
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

std::optional<double> time_of_day(const std::string& stem) {
  static const std::regex kTime(R"((?:^|\D)([01]\d|2[0-3])[-:]([0-5]\d)[-:]([0-5]\d)[-.](\d{3}|\d{6})(?!\d))");
  std::smatch found;
  if (!std::regex_search(stem, found, kTime)) return std::nullopt;
  const auto part = [&](std::size_t i) { return number_of(found[i].str()); };
  return (part(1) * 60 + part(2)) * 60 + part(3) + number_of("0." + found[4].str());
}

/// Times of day ascend, and not as a counter in their place does: by a thousandth a name.
bool are_times_of_day(const std::vector<double>& times_s) {
  constexpr double kCounterStep_s = 1.5e-3;
  return times_s.size() < 2 ||
         (std::ranges::adjacent_find(times_s, std::greater_equal()) == times_s.end() &&
          times_s.back() - times_s.front() > kCounterStep_s * static_cast<double>(times_s.size() - 1));
}

/// The numbers at a place of the names. @returns nothing when a name looks otherwise, or they do not ascend
std::optional<std::vector<std::int64_t>> numbers_at(const Names& names, std::size_t place) {
  std::vector<std::int64_t> numbers;
  for (const auto& name : names.tokens) {
    if (!names.is_usual(name)) return std::nullopt;
    const std::string& digits = name[place];
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc{} || (!numbers.empty() && number <= numbers.back())) return std::nullopt;
    numbers.push_back(number);
  }
  return numbers;
}

/// Whether one of the words of a name begins or ends with `side`, or is it where that is a letter.
bool has_side(const Tokens& name, std::string_view side) {
  return std::ranges::any_of(name, [&](const std::string& as_is) {
    const std::string word = detail::in_small_letters(as_is);
    return side.size() == 1 ? word == side : word.starts_with(side) || word.ends_with(side);
  });
}

/// Where all names have 0 or 1, or 1 or 2, and other numbers vary beside it; and the lower of the two.
std::optional<std::pair<std::size_t, std::string>> side_number(const Names& names) {
  std::vector<std::pair<std::size_t, std::string>> sides;
  bool others_vary = false;
  for (const std::size_t place : varying_places(names)) {
    std::set<std::string> values;
    for (const auto& name : names.tokens) values.insert(names.is_usual(name) ? without_zeros(name[place]) : "");
    const bool is_side = values == std::set<std::string>{"0", "1"} || values == std::set<std::string>{"1", "2"};
    if (is_side) sides.emplace_back(place, *values.begin());
    others_vary = others_vary || (!is_side && names.shape[place] == '0');
  }
  return sides.size() == 1 && others_vary ? std::optional(sides[0]) : std::nullopt;
}

}  // namespace

std::optional<std::vector<double>> times_in_names(const Paths& paths) {
  const Paths stems = stems_of(paths);
  const bool is_even = std::ranges::all_of(stems, [&](auto& stem) { return stem.size() == stems[0].size(); });
  std::vector<double> times_s;
  std::size_t of_day = 0;
  for (const auto& stem : stems) {
    auto time_s = date_and_time_of(stem);
    if (!time_s) time_s = seconds_of(stem, is_even);
    of_day += time_s ? 0 : 1;
    if (!time_s) time_s = time_of_day(stem);
    if (!time_s) return std::nullopt;
    times_s.push_back(*time_s);
  }
  if (of_day > 0 && (of_day < stems.size() || !are_times_of_day(times_s))) return std::nullopt;
  return times_s;
}

std::optional<std::vector<std::int64_t>> numbers_in_names(const Paths& paths) {
  const Names names(paths);
  std::optional<std::size_t> last;
  for (const std::size_t place : varying_places(names))
    if (names.shape[place] == '0') last = place;
  if (paths.size() == 1 && !last)
    if (const auto at = names.shape.rfind('0'); at != std::string::npos) last = at;
  return last ? numbers_at(names, *last) : std::nullopt;
}

std::optional<std::vector<std::int64_t>> finest_numbers_in_names(const Paths& paths) {
  const Names names(paths);
  std::optional<std::vector<std::int64_t>> finest;
  for (const std::size_t place : varying_places(names)) {
    auto numbers = names.shape[place] == '0' ? numbers_at(names, place) : std::nullopt;
    if (numbers && (!finest || numbers->back() - numbers->front() > finest->back() - finest->front()))
      finest = std::move(numbers);
  }
  return finest;
}

std::optional<std::pair<Paths, Paths>> sides_in_names(const Paths& paths) {
  const Names names(paths);
  const auto split = [&](auto is_left, auto is_right) -> std::optional<std::pair<Paths, Paths>> {
    std::pair<Paths, Paths> sides;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (is_left(names.tokens[i]) == is_right(names.tokens[i])) return std::nullopt;
      (is_left(names.tokens[i]) ? sides.first : sides.second).push_back(paths[i]);
    }
    return sides.first.empty() || sides.second.empty() ? std::nullopt : std::optional(sides);
  };
  for (const auto& [left, right] : {std::pair{"left", "right"}, std::pair{"l", "r"}})
    if (auto sides = split([&](const Tokens& name) { return has_side(name, left); },
                           [&](const Tokens& name) { return has_side(name, right); }))
      return sides;
  const auto number = side_number(names);
  if (!number) return std::nullopt;
  const auto is_left = [&](const Tokens& name) { return without_zeros(name[number->first]) == number->second; };
  return split(is_left, [&](const Tokens& name) { return !is_left(name); });
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
  return {stems_of(left), stems_of(right)};
}

}  // namespace flies
