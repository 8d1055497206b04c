#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace flies::detail {

/// Whether a text begins with a map or a list in brackets, after blanks and comments: JSON, or YAML's flow style.
bool is_json_text(std::string_view text);

/// The maps and lists of such a text, one behind the other (JSON Lines), as YAML: with blanks for comments (`//`,
/// `/* */`, `#`) and for tabs. What stands behind the last one comes last, unless it is blank.
std::vector<std::string> json_values_of(std::string_view text);

}  // namespace flies::detail
