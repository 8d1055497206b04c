#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace flies::detail {

/// Parses YAML of a file that need not be trusted: the one way that the library reads YAML. What comes back can be gone
/// through to its end: aliases that unfold into more than a file may hold are refused, and so is nesting without end.
/// @throws InputError naming `source` and, where there is one, the line
YAML::Node load_yaml(const std::string& text, const std::string& source);

}  // namespace flies::detail
