#include "flies/io/yaml_text.hpp"

#include <fmt/format.h>

#include "flies/core/error.hpp"

namespace flies::detail {
namespace {

constexpr std::size_t kMaxNodes = 100'000;  // ten times what the largest calibration holds
constexpr int kMaxDepth = 64;               // also ends anchors that contain themselves

/// Counts the nodes as a reader meets them, each alias as often as it is used.
void count_nodes(const YAML::Node& node, const std::string& source, int depth, std::size_t& count) {
  if (++count > kMaxNodes)
    throw InputError(source, "", fmt::format("holds more than {} values once its aliases are unfolded", kMaxNodes));
  if (depth > kMaxDepth) throw InputError(source, "", fmt::format("is nested more than {} levels deep", kMaxDepth));
  if (node.IsSequence()) {
    for (const auto& item : node) count_nodes(item, source, depth + 1, count);
  } else if (node.IsMap()) {
    for (const auto& item : node) {
      count_nodes(item.first, source, depth + 1, count);
      count_nodes(item.second, source, depth + 1, count);
    }
  }
}

/// The first line that is indented with a tab, from 1; 0: there is none.
int line_with_tab(const std::string& text) {
  int line = 1;
  bool is_indentation = true;
  for (const char letter : text) {
    if (letter == '\t' && is_indentation) return line;
    line += letter == '\n';
    is_indentation = letter == '\n' || (is_indentation && letter == ' ');
  }
  return 0;
}

}  // namespace

YAML::Node load_yaml(const std::string& text, const std::string& source) {
  try {
    YAML::Node root = YAML::Load(text);
    std::size_t count = 0;
    count_nodes(root, source, 0, count);
    return root;
  } catch (const YAML::Exception& error) {
    if (const int line = line_with_tab(text); line > 0)
      throw InputError(source, fmt::format("line {}", line),
                       "malformed YAML: is indented with a tab, expected blanks, as YAML wants them");
    throw InputError(source, error.mark.is_null() ? "" : fmt::format("line {}", error.mark.line + 1),
                     fmt::format("malformed YAML: {}", error.msg));
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // yaml-cpp also lets out what the standard library throws
    throw InputError(source, "", fmt::format("malformed YAML: {}", error.what()));
  }
}

}  // namespace flies::detail
