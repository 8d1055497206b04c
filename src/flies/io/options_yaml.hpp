#pragma once

#include <span>
#include <string>
#include <vector>

#include "flies/core/options.hpp"

namespace flies {

/// One option as a YAML file sets it; hand it to `set_option(options, path, text, source)`.
struct OptionSetting {
  std::string path;    ///< "evolve.flies"
  std::string text;    ///< "5000"
  std::string source;  ///< "options.yaml line 3", for errors
};

/// Reads options from YAML: nested maps (`evolve: {flies: 5000}`), dotted keys (`evolve.flies: 5000`) or both.
/// A file of comments alone sets nothing; one of no bytes at all is an error. Whether the options exist is for
/// `set_option` to say.
/// @throws InputError naming file, line and key: unreadable file, malformed YAML, something else than a map, a key
///         twice, a value that is a list or missing
std::vector<OptionSetting> load_options_yaml(const std::string& path);

/// The same from text; `source` names it in errors.
std::vector<OptionSetting> parse_options_yaml(const std::string& text, const std::string& source);

/// Writes options as nested YAML, each with its meaning and allowed values as a comment. Reads back to the same values.
std::string options_yaml(std::span<const OptionListing> listings);

}  // namespace flies
