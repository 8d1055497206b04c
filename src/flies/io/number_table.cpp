#include "flies/io/number_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>

#include "flies/core/error.hpp"
#include "flies/io/formats/realsense.hpp"
#include "flies/io/number_lines.hpp"
#include "flies/io/text_file.hpp"
#include "flies/io/yaml_text.hpp"

namespace flies {
namespace {

using detail::append_words;

constexpr std::size_t kMaxBytes = 1U << 20;  // calibrations take a few kilobytes
constexpr int kMaxDepth = 8;                 // of nested YAML
constexpr std::size_t kMaxNumbers = 10000;
constexpr std::size_t kMaxKeys = 1000;
constexpr int kMaxSize_px = 100000;

void check_entry_size(const NumberEntry& entry, const std::string& key, const std::string& source) {
  if (entry.numbers.size() > kMaxNumbers)
    throw InputError(source, key, fmt::format("holds more than {} numbers, no calibration does", kMaxNumbers));
}

void append_yaml_numbers(const YAML::Node& node, NumberEntry& entry, const std::string& key, const std::string& source,
                         int depth) {
  check_entry_size(entry, key, source);
  if (node.IsScalar()) append_words(entry, node.Scalar());
  if (node.IsSequence() && depth < kMaxDepth)
    for (const auto& item : node) append_yaml_numbers(item, entry, key, source, depth + 1);
}

bool holds_maps(const YAML::Node& node, int depth) {
  if (node.IsMap()) return true;
  if (!node.IsSequence() || depth >= kMaxDepth) return false;
  return std::any_of(node.begin(), node.end(), [&](const YAML::Node& item) { return holds_maps(item, depth + 1); });
}

void flatten_yaml(const YAML::Node& node, const std::string& prefix, NumberTable& table, int depth);

void add_yaml(const YAML::Node& value, const std::string& key, NumberTable& table, int depth) {
  if (table.has(key)) throw InputError(table.source, key, "stands in the file twice");
  if ((value.IsMap() && !value["data"]) || (value.IsSequence() && holds_maps(value, 0))) {
    flatten_yaml(value, key + ".", table, depth + 1);
  } else {
    append_yaml_numbers(value.IsMap() ? value["data"] : value, table.entries[key], key, table.source, 0);
  }
  if (table.entries.size() > kMaxKeys)
    throw InputError(table.source, "", fmt::format("holds more than {} keys, no calibration does", kMaxKeys));
}

void flatten_yaml(const YAML::Node& node, const std::string& prefix, NumberTable& table, int depth) {
  if (depth > kMaxDepth) throw InputError(table.source, prefix, "is nested too deeply for a calibration");
  if (node.IsSequence()) {
    for (std::size_t i = 0; i < node.size(); ++i) add_yaml(node[i], prefix + std::to_string(i), table, depth);
    return;
  }
  for (const auto& item : node)
    if (item.first.IsScalar()) add_yaml(item.second, prefix + item.first.Scalar(), table, depth);
}

/// OpenCV's YAML starts with a directive that is not YAML ("%YAML:1.0"), and needs no blank behind the colon of a key
/// ("data:[1, 0]"), which YAML does.
std::string as_yaml(const std::string& text) {
  std::string yaml;
  std::istringstream lines(text.substr(std::min(text.find('\n'), text.size())));
  for (std::string line; std::getline(lines, line); yaml += line + '\n') {
    const auto is_of_a_key = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '.'; };
    const auto first = std::find_if(line.begin(), line.end(), [](char c) { return c != ' '; });
    const auto colon = std::find_if_not(first, line.end(), is_of_a_key);
    const bool is_key = colon != first && !std::isdigit(static_cast<unsigned char>(*first)) && colon != line.end() &&
                        *colon == ':' && std::next(colon) != line.end();
    if (is_key) line.insert(std::next(colon), ' ');
  }
  return yaml;
}

void parse_yaml(std::string text, NumberTable& table) {
  if (text.starts_with("%YAML")) text = as_yaml(text);
  // JSON may be indented by tabs, YAML may not.
  if (text.find_first_not_of(" \t\n") != std::string::npos && text[text.find_first_not_of(" \t\n")] == '{')
    std::replace(text.begin(), text.end(), '\t', ' ');
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

std::string NumberTable::word(std::string_view key) const {
  const auto found = entries.find(key);
  std::string word = found == entries.end() ? "" : found->second.not_a_number;
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return word;
}

NumberTable parse_number_table(const std::string& text, const std::string& source) {
  NumberTable table{source, {}};
  if (text.find('\0') != std::string::npos) return table;  // binary: no format will know it
  if (is_opencv_xml(text)) {
    parse_xml(text, table);
  } else if (!detail::parse_realsense(text, table) && !detail::parse_lines_of_numbers(text, table)) {
    parse_yaml(text, table);
  }
  return table;
}

NumberTable read_number_table(const std::string& path) {
  return parse_number_table(plain_text(read_file(path, kMaxBytes)), path);
}

}  // namespace flies
