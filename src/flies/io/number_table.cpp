#include "flies/io/number_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <pugixml.hpp>
#include <sstream>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/text_file.hpp"
#include "flies/io/yaml_text.hpp"

namespace flies {
namespace {

constexpr std::size_t kMaxBytes = 1U << 20;  // calibrations take a few kilobytes
constexpr int kMaxDepth = 8;                 // of nested YAML
constexpr std::size_t kMaxNumbers = 10000;
constexpr std::size_t kMaxKeys = 1000;
constexpr int kMaxSize_px = 100000;

std::optional<double> parse_number(std::string_view word) {
  if (word == ".nan" || word == ".NaN" || word == ".NAN") return std::numeric_limits<double>::quiet_NaN();
  if (word == ".inf" || word == "-.inf") return std::numeric_limits<double>::infinity();
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Appends the numbers of a text such as "1 0 2; 0 1 3" or "[1, 2]".
void append_words(NumberEntry& entry, std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '[' || c == ']' || c == ';' || c == ','; }, ' ');
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (const auto number = parse_number(word))
      entry.numbers.push_back(*number);
    else if (entry.not_a_number.empty())
      entry.not_a_number = word;
  }
}

void check_entry_size(const NumberEntry& entry, const std::string& key, const std::string& source) {
  if (entry.numbers.size() > kMaxNumbers)
    throw InputError(source, key, fmt::format("holds more than {} numbers, no calibration does", kMaxNumbers));
}

/// One `key<separator>numbers` a line, as KITTI (':') and Middlebury ('=') write them.
void parse_lines(const std::string& text, char separator, NumberTable& table) {
  std::istringstream lines(text);
  NumberEntry* last = nullptr;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#')) continue;
    const auto at = line.find(separator);
    if (at == std::string::npos) {
      // Rows of a matrix may go on below their key.
      NumberEntry rest;
      append_words(rest, line);
      if (last != nullptr && rest.not_a_number.empty())
        last->numbers.insert(last->numbers.end(), rest.numbers.begin(), rest.numbers.end());
      continue;
    }
    const auto first = line.find_first_not_of(" \t");
    const auto end = line.find_last_not_of(" \t", at == 0 ? 0 : at - 1);
    if (first >= at) continue;
    const std::string key = line.substr(first, end + 1 - first);
    if (table.has(key)) throw InputError(table.source, key, "stands in the file twice");
    last = &table.entries[key];
    append_words(*last, line.substr(at + 1));
  }
}

/// Whether some line reads `cam0=` or `cam1=`.
bool has_middlebury_line(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("cam0=") || line.starts_with("cam1=")) return true;
  return false;
}

/// Whether some line reads `P0: number number` or `P_rect_00: number number`: a bare row of numbers is no YAML idiom.
bool has_kitti_line(const std::string& text) {
  std::istringstream lines(text);
  bool follows_bare_key = false;
  for (std::string line; std::getline(lines, line);) {
    std::string_view rest = line;
    if (std::exchange(follows_bare_key, false)) {
      NumberEntry row;
      append_words(row, line);
      if (row.numbers.size() > 1 && row.not_a_number.empty() && !rest.starts_with('[')) return true;
    }
    if (!rest.starts_with('P')) continue;
    rest.remove_prefix(rest.starts_with("P_rect_") ? 7 : 1);
    const auto colon = rest.find_first_not_of("0123456789");
    if (colon == 0 || colon == std::string_view::npos || rest[colon] != ':') continue;
    NumberEntry entry;
    append_words(entry, std::string(rest.substr(colon + 1)));
    if (entry.numbers.size() > 1 && rest.find('[') == std::string_view::npos) return true;
    follows_bare_key = rest.find_first_not_of(" \t\r", colon + 1) == std::string_view::npos;
  }
  return false;
}

void append_yaml_numbers(const YAML::Node& node, NumberEntry& entry, const std::string& key, const std::string& source,
                         int depth) {
  check_entry_size(entry, key, source);
  if (node.IsScalar()) append_words(entry, node.Scalar());
  if (node.IsSequence() && depth < kMaxDepth)
    for (const auto& item : node) append_yaml_numbers(item, entry, key, source, depth + 1);
}

void flatten_yaml(const YAML::Node& node, const std::string& prefix, NumberTable& table, int depth) {
  if (depth > kMaxDepth) throw InputError(table.source, prefix, "is nested too deeply for a calibration");
  for (const auto& item : node) {
    if (!item.first.IsScalar()) continue;
    const std::string key = prefix + item.first.Scalar();
    if (table.has(key)) throw InputError(table.source, key, "stands in the file twice");
    const YAML::Node& value = item.second;
    if (value.IsMap() && !value["data"]) {
      flatten_yaml(value, key + ".", table, depth + 1);
    } else {
      append_yaml_numbers(value.IsMap() ? value["data"] : value, table.entries[key], key, table.source, 0);
    }
    if (table.entries.size() > kMaxKeys)
      throw InputError(table.source, "", fmt::format("holds more than {} keys, no calibration does", kMaxKeys));
  }
}

void parse_yaml(std::string text, NumberTable& table) {
  // OpenCV starts its YAML with a directive that is not YAML ("%YAML:1.0").
  if (text.starts_with("%YAML")) text.erase(0, text.find('\n'));
  const YAML::Node root = detail::load_yaml(text, table.source);
  if (root.IsMap()) flatten_yaml(root, "", table, 0);
}

bool is_opencv_xml(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<' && text.find("<opencv_storage") != std::string::npos;
}

/// A matrix has its numbers in its child `data`, a list in children `_`, a number or a size in its own text.
void append_xml_numbers(const pugi::xml_node& node, NumberEntry& entry) {
  append_words(entry, node.child("data") ? node.child_value("data") : node.child_value());
  for (const pugi::xml_node item : node.children("_")) append_words(entry, item.child_value());
}

/// OpenCV's own reader answers some damaged files with exceptions of the standard library, others with a full stack.
void parse_xml(const std::string& text, NumberTable& table) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw InputError(table.source, fmt::format("byte {}", parsed.offset),
                     fmt::format("malformed OpenCV XML: {}", parsed.description()));
  for (const pugi::xml_node item : document.child("opencv_storage").children()) {
    if (item.type() != pugi::node_element) continue;
    if (table.has(item.name())) throw InputError(table.source, item.name(), "stands in the file twice");
    append_xml_numbers(item, table.entries[item.name()]);
    check_entry_size(table.entries[item.name()], item.name(), table.source);
  }
}

}  // namespace

const std::vector<double>& NumberTable::require(std::string_view key) const {
  const auto found = entries.find(key);
  if (found == entries.end()) throw InputError(source, std::string(key), "is missing");
  const auto& [numbers, not_a_number] = found->second;
  if (!not_a_number.empty())
    throw InputError(source, std::string(key), fmt::format("found '{}', expected numbers", not_a_number));
  if (numbers.empty()) throw InputError(source, std::string(key), "found nothing, expected numbers");
  for (const double number : numbers)
    if (!std::isfinite(number))
      throw InputError(source, std::string(key), fmt::format("found {}, expected finite numbers", number));
  return numbers;
}

const std::vector<double>& NumberTable::require(std::string_view key, std::size_t count) const {
  const auto& numbers = require(key);
  if (numbers.size() != count)
    throw InputError(
        source, std::string(key),
        fmt::format("found {} number{}, expected {}", numbers.size(), numbers.size() == 1 ? "" : "s", count));
  return numbers;
}

int NumberTable::require_size(std::string_view key) const {
  const double size = require_number(key);
  if (size < 1 || size > kMaxSize_px || size != std::floor(size))
    throw InputError(source, std::string(key),
                     fmt::format("found {}, expected a whole number of pixels, 1..{}", size, kMaxSize_px));
  return static_cast<int>(size);
}

NumberTable parse_number_table(const std::string& text, const std::string& source) {
  NumberTable table{source, {}};
  if (text.find('\0') != std::string::npos) return table;  // binary: no format will know it
  if (is_opencv_xml(text)) {
    parse_xml(text, table);
  } else if (has_middlebury_line(text)) {
    parse_lines(text, '=', table);
  } else if (has_kitti_line(text)) {
    parse_lines(text, ':', table);
  } else {
    parse_yaml(text, table);
  }
  return table;
}

NumberTable read_number_table(const std::string& path) {
  return parse_number_table(plain_text(read_file(path, kMaxBytes)), path);
}

}  // namespace flies
