#include "flies/core/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "flies/core/error.hpp"
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

template <class Number>
Number parse_number(std::string_view text, Range range, const char* kind, const std::string& path,
                    const std::string& source) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw InputError(source, path, fmt::format("found '{}', expected {}", text, kind));
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
  if (text == "true" || text == "on" || text == "yes" || text == "1") return true;
  if (text == "false" || text == "off" || text == "no" || text == "0") return false;
  throw InputError(source, path, fmt::format("found '{}', expected true or false", text));
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
    throw InputError(source, path, fmt::format("found '{}', expected {}", text, join_names(names)));
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
      throw InputError(source, std::string(path), fmt::format("a group of options, not one; '{}' is in it", name));
  const std::string nearest = nearest_name(path, known);
  throw InputError(
      source, std::string(path),
      nearest.empty() ? "unknown option" : fmt::format("unknown option; the nearest known one is '{}'", nearest));
}

}  // namespace detail
}  // namespace flies
