#include "flies/core/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <type_traits>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/core/name_hint.hpp"

namespace flies {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// For errors, which a zero byte would cut off.
std::string shown(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '\0' ? std::string("\\0") : std::string(1, c);
  return result;
}

/// What a plus sign stands before is a number as well as what a minus sign does.
std::string_view without_plus(std::string_view text) {
  constexpr std::string_view kBegin = ".0123456789";
  const bool has_plus = text.size() > 1 && text[0] == '+' && kBegin.find(text[1]) != std::string_view::npos;
  return has_plus ? text.substr(1) : text;
}

/// "3000.0" is the whole number 3000, as Python writes it where it counts with fractions.
std::string_view without_zero_fraction(std::string_view text) {
  const auto point = text.find('.');
  if (point == 0 || point == std::string_view::npos) return text;
  return text.find_first_not_of('0', point + 1) == std::string_view::npos ? text.substr(0, point) : text;
}

template <class Number>
Number parse_number(std::string_view text, Range range, const char* kind, const std::string& path,
                    const std::string& source) {
  std::string_view digits = without_plus(text);
  if constexpr (std::is_integral_v<Number>) digits = without_zero_fraction(digits);
  Number value{};
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size())
    throw InputError(source, path, fmt::format("found '{}', expected {}", shown(text), kind));
  const auto as_double = static_cast<double>(value);
  if (!std::isfinite(as_double) || as_double < range.min || as_double > range.max)
    throw InputError(source, path, fmt::format("found {}, expected {} in {}", text, kind, detail::range_text(range)));
  return value;
}

}  // namespace

std::string nearest_name(std::string_view name, std::span<const std::string> known) {
  if (known.empty()) return {};
  const auto nearest = *std::min_element(known.begin(), known.end(), [&](const std::string& a, const std::string& b) {
    return edit_distance(name, a) < edit_distance(name, b);
  });
  return 2 * edit_distance(name, nearest) <= std::max(name.size(), nearest.size()) ? nearest : std::string();
}

std::string did_you_mean(std::string_view name, std::span<const std::string> known, std::string_view quote) {
  const std::string nearest = nearest_name(name, known);
  return nearest.empty() ? std::string() : fmt::format("; did you mean {}{}{}?", quote, nearest, quote);
}

namespace detail {

bool parse_bool(std::string_view text, const std::string& path, const std::string& source) {
  const std::string plain = in_small_letters(text);  // Python writes True, YAML also TRUE
  if (plain == "true" || plain == "on" || plain == "yes" || plain == "1") return true;
  if (plain == "false" || plain == "off" || plain == "no" || plain == "0") return false;
  throw InputError(source, path, fmt::format("found '{}', expected true or false", shown(text)));
}

std::int64_t parse_int(std::string_view text, Range range, const std::string& path, const std::string& source) {
  return parse_number<std::int64_t>(text,
                                    {std::max(range.min, double{std::numeric_limits<int>::min()}),
                                     std::min(range.max, double{std::numeric_limits<int>::max()})},
                                    "a whole number", path, source);
}

std::uint64_t parse_uint64(std::string_view text, const std::string& path, const std::string& source) {
  return parse_number<std::uint64_t>(text, {}, "a whole number of 0 or more", path, source);
}

double parse_double(std::string_view text, Range range, const std::string& path, const std::string& source) {
  return parse_number<double>(text, range, "a number", path, source);
}

std::size_t parse_name(std::string_view text, std::span<const std::string_view> names, const std::string& path,
                       const std::string& source) {
  const auto match = std::find(names.begin(), names.end(), text);
  if (match == names.end())
    throw InputError(source, path, fmt::format("found '{}', expected {}", shown(text), join_names(names)));
  return static_cast<std::size_t>(match - names.begin());
}

std::string double_text(double value) { return fmt::format("{}", value); }

std::string range_text(Range range) {
  const bool has_min = std::isfinite(range.min), has_max = std::isfinite(range.max);
  if (has_min && has_max) return fmt::format("{}..{}", range.min, range.max);
  if (has_min) return fmt::format(">= {}", range.min);
  if (has_max) return fmt::format("<= {}", range.max);
  return "any";
}

std::string join_names(std::span<const std::string_view> names) { return fmt::format("{}", fmt::join(names, "|")); }

void throw_unknown_option(std::string_view path, std::span<const std::string> known, const std::string& source) {
  const std::string group = std::string(path) + ".";
  for (const auto& name : known)
    if (name.starts_with(group))
      throw InputError(source, shown(path), fmt::format("a group of options, not one; '{}' is in it", name));
  const std::string nearest = nearest_name(path, known);
  throw InputError(
      source, shown(path),
      nearest.empty() ? "unknown option" : fmt::format("unknown option; the nearest known one is '{}'", nearest));
}

}  // namespace detail
}  // namespace flies
