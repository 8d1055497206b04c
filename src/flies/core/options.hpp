#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

/// One declaration serves every reader of an option. A struct of options lists its fields once:
///
///     struct RoadOptions {
///       bool estimate = true;
///       double max_slope = 0.1;
///
///       template <class Self, class Field>
///       static void fields(Self& self, Field&& field) {
///         field("estimate", self.estimate, "fit the road plane to the pair");
///         field("max_slope", self.max_slope, Range{0.0, 0.3}, "steepest road looked for, rise per metre");
///       }
///     };
///
/// The command line, YAML files and printed lists all go through `list_options` and `set_option`. Fields
/// are bool, int, std::uint64_t, double, an enumeration with names (see `EnumNames`) or a nested struct of options.
namespace flies {

/// Closed interval of allowed values.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// Specialise for every enumeration used as an option: the names in the order of the enumerators, which count from 0.
///     template <> struct EnumNames<Colour> { static constexpr std::array<std::string_view, 2> names = {...}; };
template <class Enum>
struct EnumNames;

template <class T>
concept NamedEnum = std::is_enum_v<T> && requires {
  EnumNames<T>::names;
};

template <NamedEnum Enum>
constexpr std::string_view enum_name(Enum value) {
  const auto index = static_cast<std::size_t>(value);
  return index < EnumNames<Enum>::names.size() ? EnumNames<Enum>::names[index] : "no such value";
}

/// One option as text, ready to print.
struct OptionListing {
  std::string path;     ///< "evolve.flies"
  std::string value;    ///< "5000"
  std::string allowed;  ///< "100..1000000", "true|false" or the names of an enumeration
  std::string meaning;
  bool is_enum_or_bool = false;
};

namespace detail {

// Parsers throw InputError{source, path, ...} when the text is not of the type or out of range.
bool parse_bool(std::string_view text, const std::string& path, const std::string& source);
std::int64_t parse_int(std::string_view text, Range range, const std::string& path, const std::string& source);
std::uint64_t parse_uint64(std::string_view text, const std::string& path, const std::string& source);
double parse_double(std::string_view text, Range range, const std::string& path, const std::string& source);
std::size_t parse_name(std::string_view text, std::span<const std::string_view> names, const std::string& path,
                       const std::string& source);
std::string double_text(double value);  ///< shortest text that reads back to the same value
std::string range_text(Range range);
std::string join_names(std::span<const std::string_view> names);
[[noreturn]] void throw_unknown_option(std::string_view path, std::span<const std::string> known,
                                       const std::string& source);

/// Calls `leaf(path, field, range, meaning)` for every leaf below `options`.
template <class Options, class Leaf>
void for_each_leaf(Options& options, const std::string& prefix, const Leaf& leaf);

/// What the `fields` function of a struct of options calls, once per field.
template <class Leaf>
struct LeafVisitor {
  const std::string& prefix;
  const Leaf& leaf;

  template <class T>
  void operator()(std::string_view name, T& field, Range range, std::string_view meaning) const {
    leaf(prefix + std::string(name), field, range, meaning);
  }
  template <class T>
  void operator()(std::string_view name, T& field, std::string_view meaning) const {
    (*this)(name, field, Range{}, meaning);
  }
  template <class T>
  void operator()(std::string_view name, T& nested) const {
    for_each_leaf(nested, prefix + std::string(name) + ".", leaf);
  }
};

template <class Options, class Leaf>
void for_each_leaf(Options& options, const std::string& prefix, const Leaf& leaf) {
  std::remove_const_t<Options>::fields(options, LeafVisitor<Leaf>{prefix, leaf});
}

/// Clears `ok` when some field is out of its range. Needs no text and no memory, unlike `for_each_leaf`.
struct RangeChecker {
  bool& ok;

  template <class T>
  void operator()(std::string_view, const T& field, Range range, std::string_view) const {
    if constexpr (NamedEnum<T>) {
      ok = ok && static_cast<std::size_t>(field) < EnumNames<T>::names.size();
    } else if constexpr (std::same_as<T, double>) {
      ok = ok && std::isfinite(field) && field >= range.min && field <= range.max;
    } else if constexpr (std::same_as<T, int>) {
      ok = ok && field >= range.min && field <= range.max;
    }
  }
  template <class T>
  void operator()(std::string_view name, const T& field, std::string_view meaning) const {
    (*this)(name, field, Range{}, meaning);
  }
  template <class T>
  void operator()(std::string_view, const T& nested) const {
    T::fields(nested, *this);
  }
};

}  // namespace detail

/// All options below `options` with their present values, in order of declaration.
template <class Options>
std::vector<OptionListing> list_options(const Options& options) {
  std::vector<OptionListing> listings;
  detail::for_each_leaf(options, "",
                        [&]<class T>(std::string path, const T& field, Range range, std::string_view meaning) {
                          OptionListing listing{std::move(path), {}, {}, std::string(meaning)};
                          if constexpr (std::same_as<T, bool>) {
                            listing.value = field ? "true" : "false";
                            listing.allowed = "true|false";
                            listing.is_enum_or_bool = true;
                          } else if constexpr (NamedEnum<T>) {
                            listing.value = enum_name(field);
                            listing.allowed = detail::join_names(EnumNames<T>::names);
                            listing.is_enum_or_bool = true;
                          } else if constexpr (std::same_as<T, double>) {
                            listing.value = detail::double_text(field);
                            listing.allowed = detail::range_text(range);
                          } else {
                            static_assert(std::integral<T>);
                            listing.value = std::to_string(field);
                            listing.allowed = std::same_as<T, std::uint64_t> ? ">= 0" : detail::range_text(range);
                          }
                          listings.push_back(std::move(listing));
                        });
  return listings;
}

/// Sets the option at `path` from text.
/// @param source names where the text comes from in errors, e.g. "command line" or a file name
/// @throws InputError on an unknown path (the message names the nearest known one), a value that is not of the
///         option's type, not finite, or out of range
template <class Options>
void set_option(Options& options, std::string_view path, std::string_view text, const std::string& source) {
  bool found = false;
  std::vector<std::string> known;
  detail::for_each_leaf(options, "", [&]<class T>(std::string leaf_path, T& field, Range range, std::string_view) {
    known.push_back(leaf_path);
    if (leaf_path != path) return;
    found = true;
    if constexpr (std::same_as<T, bool>) {
      field = detail::parse_bool(text, leaf_path, source);
    } else if constexpr (NamedEnum<T>) {
      field = static_cast<T>(detail::parse_name(text, EnumNames<T>::names, leaf_path, source));
    } else if constexpr (std::same_as<T, double>) {
      field = detail::parse_double(text, range, leaf_path, source);
    } else if constexpr (std::same_as<T, std::uint64_t>) {
      field = detail::parse_uint64(text, leaf_path, source);
    } else {
      static_assert(std::same_as<T, int>);
      field = static_cast<int>(detail::parse_int(text, range, leaf_path, source));
    }
  });
  if (!found) detail::throw_unknown_option(path, known, source);
}

/// Checks every value against its declared range, for options that were set in code. Costs next to nothing when all is
/// well: every stage that may be called on its own does it.
/// @throws InputError naming `source` and the option
template <class Options>
void check_options(const Options& options, std::string_view source_name) {
  bool ok = true;
  Options::fields(options, detail::RangeChecker{ok});
  if (ok) return;
  const std::string source(source_name);
  Options copy = options;
  for (const auto& listing : list_options(options)) set_option(copy, listing.path, listing.value, source);
}

/// The name among `known` that is fewest edits away from `name`; empty where none is near.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

}  // namespace flies
