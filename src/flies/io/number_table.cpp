#include "flies/io/number_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/io/foreign_files.hpp"
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

void check_count(const NumberTable& table) {
  if (table.entries.size() > kMaxKeys)
    throw InputError(table.source, "", fmt::format("holds more than {} keys, no calibration does", kMaxKeys));
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
  check_count(table);
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

/// The documents of a YAML text that hold something: lines of `---` stand between them.
std::vector<std::string> documents_of(const std::string& text) {
  std::vector<std::string> documents(1);
  bool is_blank = true;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto first = line.find_first_not_of(" \t"), last = line.find_last_not_of(" \t");
    const bool is_border = last == 2 && line.starts_with("---");
    if (is_border && !is_blank) documents.emplace_back();
    if (is_border && is_blank) documents.back().clear();
    if (is_border) is_blank = true;
    if (is_border) continue;
    documents.back() += line + '\n';
    is_blank = is_blank && (first == std::string::npos || line[first] == '#' || line[first] == '%');
  }
  if (is_blank && documents.size() > 1) documents.pop_back();
  return documents;
}

NumberTable table_of(const std::string& yaml, const std::string& source) {
  NumberTable table{source, {}};
  const YAML::Node root = detail::load_yaml(yaml, source);
  if (root.IsMap() || holds_maps(root, 0)) flatten_yaml(root, "", table, 0);
  return table;
}

/// The projection matrix of a ROS camera; nothing in another document.
const NumberEntry* projection_of(const NumberTable& table) {
  for (const char* key : {"projection_matrix", "P", "p"})
    if (const auto found = table.entries.find(key); found != table.entries.end()) return &found->second;
  return nullptr;
}

/// Messages of ROS that were printed one after the other: of one camera again and again, or of the left and of the
/// right one. What OpenCV appends to a file are more keys of the same.
void merge_documents(const std::vector<std::string>& documents, NumberTable& table) {
  constexpr std::size_t kMost = 1000;  // each costs a comparison with all cameras, of which there are two
  if (documents.size() > kMost)
    throw InputError(
        table.source, "",
        fmt::format("holds {} documents (between lines of ---), expected at most {}", documents.size(), kMost));
  std::vector<NumberTable> cameras;
  for (std::size_t i = 0; i < documents.size(); ++i) {
    const bool may_be_cut = i > 0 && i + 1 == documents.size() && projection_of(cameras.front());
    NumberTable camera{table.source, {}};
    try {
      camera = table_of(documents[i], table.source);
    } catch (const InputError&) {
      if (!may_be_cut) throw;
    }
    if (may_be_cut && !projection_of(camera)) break;  // a message that was being printed when the program was ended
    const NumberEntry* projection = projection_of(camera);
    const bool is_known = projection && std::ranges::any_of(cameras, [&](const NumberTable& other) {
                            return projection_of(other) && projection_of(other)->numbers == projection->numbers;
                          });
    if (!is_known) cameras.push_back(std::move(camera));
  }
  const bool are_ros = std::ranges::all_of(cameras, [](const NumberTable& camera) { return projection_of(camera); });
  if (are_ros && cameras.size() > 2)
    throw InputError(
        table.source, "",
        fmt::format("holds {} cameras between lines of ---, expected the left and then the right one", cameras.size()));
  const bool is_pair = are_ros && cameras.size() == 2;
  for (std::size_t i = 0; i < cameras.size(); ++i)
    for (auto& [key, entry] : cameras[i].entries) {
      const std::string whole = (!is_pair ? "" : i == 0 ? "left." : "right.") + key;
      if (!table.entries.emplace(whole, std::move(entry)).second)
        throw InputError(table.source, whole,
                         fmt::format("stands in two of the {} documents that the file holds (between lines of ---)",
                                     documents.size()));
      check_count(table);
    }
}

void parse_yaml(std::string text, NumberTable& table) {
  if (text.starts_with("%YAML")) text = as_yaml(text);
  // JSON may be indented by tabs, YAML may not.
  if (text.find_first_not_of(" \t\n") != std::string::npos && text[text.find_first_not_of(" \t\n")] == '{')
    std::replace(text.begin(), text.end(), '\t', ' ');
  const auto documents = documents_of(text);
  if (documents.size() > 1) return merge_documents(documents, table);
  table.entries = table_of(text, table.source).entries;
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

/// Whether a node holds others by their names, and is neither a matrix nor a list.
bool is_xml_map(const pugi::xml_node& node) {
  return !node.child("data") && std::any_of(node.begin(), node.end(), [](const pugi::xml_node& child) {
    return child.type() == pugi::node_element && std::string_view(child.name()) != "_";
  });
}

void flatten_xml(const pugi::xml_node& node, const std::string& prefix, NumberTable& table, int depth) {
  if (depth > kMaxDepth) throw InputError(table.source, prefix, "is nested too deeply for a calibration");
  int count = 0;  // of items of a list of maps
  for (const pugi::xml_node item : node.children()) {
    if (item.type() != pugi::node_element) continue;
    const bool is_item = std::string_view(item.name()) == "_";
    const std::string key = prefix + (is_item ? std::to_string(count++) : std::string(item.name()));
    const auto holds_map = [](const pugi::xml_node& child) { return is_xml_map(child); };
    if (is_xml_map(item) || std::any_of(item.children("_").begin(), item.children("_").end(), holds_map)) {
      flatten_xml(item, key + ".", table, depth + 1);
      continue;
    }
    if (table.has(key) && depth == 0) throw InputError(table.source, key, "stands in the file twice");
    append_xml_numbers(item, table.entries[key]);
    check_entry_size(table.entries[key], key, table.source);
    check_count(table);
  }
}

/// OpenCV's own reader answers some damaged files with exceptions of the standard library, others with a full stack.
void parse_xml(const std::string& text, NumberTable& table) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw InputError(table.source, fmt::format("byte {}", parsed.offset),
                     fmt::format("malformed OpenCV XML: {}", parsed.description()));
  flatten_xml(document.child("opencv_storage"), "", table, 0);
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
  return found == entries.end() ? "" : detail::in_small_letters(found->second.not_a_number);
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
  const std::string bytes = read_file(path, kMaxBytes);
  detail::check_no_foreign_file(bytes, path);
  return parse_number_table(plain_text(bytes), path);
}

}  // namespace flies
