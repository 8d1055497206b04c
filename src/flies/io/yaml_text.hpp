#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace flies::detail {

/// The documents of a text that hold something, each as YAML: lines of `---` stand between them, and JSON values may
/// follow one the other (JSON Lines). JSON loses its comments and tabs.
std::vector<std::string> documents_of(const std::string& text);

/// Parses YAML of a file that need not be trusted: the one way that the library reads YAML. What comes back can be gone
/// through to its end: aliases that unfold into more than a file may hold are refused, and so is nesting without end.
/// @throws InputError naming `source` and, where there is one, the line; also where the text has several documents
YAML::Node load_yaml(const std::string& text, const std::string& source);

}  // namespace flies::detail
