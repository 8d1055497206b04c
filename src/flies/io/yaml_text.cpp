#include "flies/io/yaml_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/io/json_text.hpp"

namespace flies::detail {
namespace {

constexpr std::size_t kMaxNodes = 100'000;  // ten times what the largest calibration holds
constexpr int kMaxDepth = 64;               // also ends anchors that contain themselves

/// Whether this is a number that no quotes stand round.
bool is_bare_number(const YAML::Node& node) {
  if (!node.IsScalar() || node.Tag() == "!") return false;
  const std::string& word = node.Scalar();
  const bool has_digit = std::ranges::any_of(word, [](unsigned char c) { return std::isdigit(c); });
  return has_digit && word.find_first_not_of("+-.0123456789eE") == std::string::npos;
}

/// In `{baseline: 1,2}` YAML ends the entry at the comma, and takes the 2 as the key of another one without a value.
/// Where no entry has a value, it is a set.
/// @throws InputError when a number stands for an entry of its own behind one that is a number, which is never meant
void check_no_decimal_comma(const YAML::Node& map, const std::string& source) {
  const bool is_set = std::all_of(map.begin(), map.end(), [](const auto& item) { return item.second.IsNull(); });
  if (map.Style() != YAML::EmitterStyle::Flow || is_set) return;
  std::string name, value;
  for (const auto& item : map) {
    const std::string number = item.first.IsScalar() ? item.first.Scalar() : "";
    if (!value.empty() && is_bare_number(item.first) && item.second.IsNull())
      throw InputError(
          source, name,
          fmt::format("found '{},{}', expected a decimal point: a decimal comma ends the entry", value, number));
    name = number;
    value = is_bare_number(item.second) ? item.second.Scalar() : "";
  }
}

/// Counts the nodes as a reader meets them, each alias as often as it is used.
void count_nodes(const YAML::Node& node, const std::string& source, int depth, std::size_t& count) {
  if (++count > kMaxNodes)
    throw InputError(source, "", fmt::format("holds more than {} values once its aliases are unfolded", kMaxNodes));
  if (depth > kMaxDepth) throw InputError(source, "", fmt::format("is nested more than {} levels deep", kMaxDepth));
  if (node.IsSequence()) {
    for (const auto& item : node) count_nodes(item, source, depth + 1, count);
  } else if (node.IsMap()) {
    check_no_decimal_comma(node, source);
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

/// The first line that has no blank behind the colon of its key, from 1, and the key; 0: there is none.
struct KeyWithoutBlank {
  int line = 0;
  std::string key;
};
KeyWithoutBlank key_without_blank(const std::string& text) {
  const auto is_of_a_key = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const auto first = std::find_if(line.begin(), line.end(), [](char c) { return c != ' '; });
    const auto colon = std::find_if_not(first, line.end(), is_of_a_key);
    const std::string_view rest(line.data() + (colon - line.begin()), static_cast<std::size_t>(line.end() - colon));
    const bool is_glued = rest.size() > 1 && rest[0] == ':' && std::string_view(" \t:/\\").find(rest[1]) == rest.npos;
    if (colon != first && is_glued) return {number, std::string(first, colon)};
  }
  return {};
}

/// What YAML wants otherwise than people write it, which its own errors do not name.
void check_habits(const std::string& text, const std::string& source) {
  if (const int line = line_with_tab(text); line > 0)
    throw InputError(source, fmt::format("line {}", line),
                     "malformed YAML: is indented with a tab, expected blanks, as YAML wants them");
  if (const auto glued = key_without_blank(text); glued.line > 0)
    throw InputError(
        source, fmt::format("line {}", glued.line),
        fmt::format("malformed YAML: found no blank behind '{}:', expected one, as YAML wants it", glued.key));
}

/// Whether a document begins or ends here: `---`, what it holds may stand behind that, or `...`
bool is_border(std::string_view line) {
  const bool is_mark = line.starts_with("---") || line.starts_with("...");
  return is_mark && (line.size() == 3 || line[3] == ' ' || line[3] == '\t');
}

/// As `documents_of`, of borders alone.
std::vector<std::string> between_borders(const std::string& text) {
  std::vector<std::string> documents(1);
  bool is_blank = true;
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    if (is_border(line)) {
      if (!is_blank) documents.emplace_back();
      // Errors name lines.
      documents.back() = documents.size() == 1 ? std::string(static_cast<std::size_t>(count), '\n') : "";
      is_blank = true;
      line.replace(0, 3, "   ");
    }
    documents.back() += line + '\n';
    const auto first = line.find_first_not_of(" \t");
    is_blank = is_blank && (first == std::string::npos || line[first] == '#' || line[first] == '%');
  }
  if (is_blank && documents.size() > 1) documents.pop_back();
  return documents;
}

}  // namespace

std::vector<std::string> documents_of(const std::string& text) {
  std::vector<std::string> documents;
  for (auto& document : between_borders(text)) {
    if (!is_json_text(document)) {
      documents.push_back(std::move(document));
      continue;
    }
    for (auto& value : json_values_of(document)) documents.push_back(std::move(value));
  }
  return documents;
}

YAML::Node load_yaml(const std::string& text, const std::string& source) {
  const auto documents = documents_of(text);
  if (documents.size() != 1)
    throw InputError(source, "",
                     fmt::format("holds {} documents, one behind the other, expected one", documents.size()));
  try {
    YAML::Node root = YAML::Load(documents[0]);
    std::size_t count = 0;
    count_nodes(root, source, 0, count);
    return root;
  } catch (const YAML::Exception& error) {
    check_habits(documents[0], source);
    throw InputError(source, error.mark.is_null() ? "" : fmt::format("line {}", error.mark.line + 1),
                     fmt::format("malformed YAML: {}", error.msg));
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // yaml-cpp also lets out what the standard library throws
    throw InputError(source, "", fmt::format("malformed YAML: {}", error.what()));
  }
}

}  // namespace flies::detail
