#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <type_traits>

/// Has all helps break descriptions that would not fit a line of 100 characters.
void wrap_help(CLI::App& app);

/// Refuses values that tell of a mistake: an empty one, such as of a variable of the shell that is not set, and the
/// name of another option, where an option's own value was forgotten.
void check_values(CLI::App& app);

/// @throws flies::InputError on `--name=` without a value, of which CLI11 takes the next word
void refuse_empty_assignments(int argc, const char* const* argv);

/// How often the command line has an option, by any of its names.
int times_given(const CLI::Option& option, int argc, const char* const* argv);

/// A number from `least` to `most`. CLI11's own Range takes NaN.
template <class Number>
CLI::Validator in_range(Number least, Number most) {
  CLI::Validator validator = CLI::Range(least, most);
  validator.operation([least, most](const std::string& text) {
    Number number{};
    const bool is_number = CLI::detail::lexical_cast(text, number);
    return is_number && number >= least && number <= most
               ? std::string()
               : fmt::format("found {}, expected a {}number in {}..{}", text,
                             std::is_integral_v<Number> ? "whole " : "", least, most);
  });
  return validator;
}
