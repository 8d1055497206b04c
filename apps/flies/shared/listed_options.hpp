#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/options.hpp"

/// Options set on the command line, name and text, in the order given.
using Overrides = std::vector<std::pair<std::string, std::string>>;

/// Adds an option `--NAME` for each one that `Options` lists.
/// @param prefix    of the names, such as "dense."
/// @param group     heading in the help; empty: not in it
/// @param overrides gets what is set; it must outlive the command
template <class Options>
void add_listed_options(CLI::App& command, const std::string& prefix, const std::string& group, Overrides& overrides) {
  for (const auto& listing : flies::list_options(Options{}))
    command
        .add_option_function<std::string>(
            "--" + prefix + listing.path,
            [&overrides, path = listing.path](const std::string& text) { overrides.emplace_back(path, text); },
            fmt::format("{}; {}, default {}", listing.meaning, listing.allowed, listing.value))
        ->type_name("N")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->group(group);
}

/// The defaults with what was set. @throws flies::InputError on an unknown option or a value out of range
template <class Options>
Options with_overrides(const Overrides& overrides) {
  Options options;
  for (const auto& [path, text] : overrides) flies::set_option(options, path, text, "command line");
  return options;
}
