#include "flies/io/number_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/io/foreign_files.hpp"
#include "flies/io/formats/realsense.hpp"
#include "flies/io/formats/sides.hpp"
#include "flies/io/number_lines.hpp"
#include "flies/io/opencv_base64.hpp"
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
  if (node.IsScalar() && detail::is_opencv_base64(node.Scalar(), node.Tag()))
    detail::append_opencv_base64(node.Scalar(), entry);
  else if (node.IsScalar())
    append_words(entry, node.Scalar());
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

/// YAML wants a blank behind the colon of a key. OpenCV's does not ("data:[1, 0]"), and people forget it ("fx:700").
/// @param words where the value is no number, list or map either: elsewhere `host:port` is a word
std::string with_blanks_behind_keys(const std::string& text, bool words) {
  std::string yaml;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line); yaml += line + '\n') {
    const auto is_of_a_key = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '.'; };
    const auto first = std::find_if(line.begin(), line.end(), [](char c) { return c != ' '; });
    const auto colon = std::find_if_not(first, line.end(), is_of_a_key);
    const bool is_key = colon != first && !std::isdigit(static_cast<unsigned char>(*first)) && colon != line.end() &&
                        *colon == ':' && std::next(colon) != line.end();
    if (is_key && (words || std::string_view("+-.[{0123456789").find(*std::next(colon)) != std::string_view::npos))
      line.insert(std::next(colon), ' ');
  }
  return yaml;
}

/// OpenCV's YAML starts with a directive that is not YAML: "%YAML:1.0".
std::string as_yaml(const std::string& text) {
  const bool is_opencv = text.starts_with("%YAML");
  return with_blanks_behind_keys(is_opencv ? text.substr(std::min(text.find('\n'), text.size())) : text, is_opencv);
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

/// By the names that messages or files of ROS give their cameras, where the projections do not say otherwise.
bool is_right_before_left(const NumberTable& first, const NumberTable& second) {
  constexpr std::size_t kCount = 12, kShift = 3;
  const auto &one = projection_of(first)->numbers, &other = projection_of(second)->numbers;
  if (one.size() != kCount || other.size() != kCount || one[kShift] > other[kShift]) return false;
  return std::ranges::any_of(std::array{"header.frame_id", "camera_name"}, [&](const char* key) {
    const std::string of_first = first.word(key), of_second = second.word(key);
    return detail::is_left_and_right(of_second, of_first) && !detail::is_left_and_right(of_first, of_second);
  });
}

bool are_same(const NumberEntry& a, const NumberEntry& b) {
  return a.numbers == b.numbers && a.not_a_number == b.not_a_number;
}

bool have_same_entries(const NumberTable& a, const NumberTable& b) {
  return std::ranges::equal(a.entries, b.entries, [](const auto& one, const auto& other) {
    return one.first == other.first && are_same(one.second, other.second);
  });
}

std::string first_line_of(const std::string& text) {
  const auto first = std::min(text.find_first_not_of(" \t\n"), text.size());
  return text.substr(first, std::min(text.find('\n', first), text.size()) - first);
}

/// Messages of ROS that were printed one after the other: of one camera again and again, or of the left and of the
/// right one. What OpenCV appends to a file are more keys of the same. A log may repeat all of a calibration.
void merge_documents(const std::vector<std::string>& documents, NumberTable& table) {
  constexpr std::size_t kMost = 1000;  // each costs a comparison with all cameras, of which there are two
  if (documents.size() > kMost)
    throw InputError(
        table.source, "",
        fmt::format("holds {} documents, one behind the other, expected at most {}", documents.size(), kMost));
  std::vector<NumberTable> cameras;
  for (std::size_t i = 0; i < documents.size(); ++i) {
    const bool may_be_cut = i > 0 && i + 1 == documents.size() && projection_of(cameras.front());
    NumberTable camera{table.source, {}};
    try {
      camera = table_of(documents[i], table.source);
    } catch (const InputError&) {
      if (!may_be_cut) throw;
    }
    if (may_be_cut && !projection_of(camera)) {  // a message that was being printed when the program was ended
      table.is_cut_off = true;
      break;
    }
    if (i > 0 && camera.entries.empty())
      throw InputError(table.source, "",
                       fmt::format("found '{}' behind the first of its maps, expected nothing or another one",
                                   first_line_of(documents[i])));
    const NumberEntry* projection = projection_of(camera);
    const bool is_known = std::ranges::any_of(cameras, [&](const NumberTable& other) {
      const NumberEntry* known = projection_of(other);
      return (projection && known && known->numbers == projection->numbers) || have_same_entries(camera, other);
    });
    if (!is_known) cameras.push_back(std::move(camera));
  }
  const bool are_ros = std::ranges::all_of(cameras, [](const NumberTable& camera) { return projection_of(camera); });
  if (are_ros && cameras.size() > 2)
    throw InputError(
        table.source, "",
        fmt::format("holds {} cameras between lines of ---, expected the left and then the right one", cameras.size()));
  const bool is_pair = are_ros && cameras.size() == 2;
  if (is_pair && is_right_before_left(cameras[0], cameras[1])) std::swap(cameras[0], cameras[1]);
  for (std::size_t i = 0; i < cameras.size(); ++i)
    for (const auto& [key, entry] : cameras[i].entries) {
      const std::string whole = (!is_pair ? "" : i == 0 ? "left." : "right.") + key;
      const auto [at, is_new] = table.entries.try_emplace(whole, entry);
      if (!is_new && !are_same(at->second, entry))
        throw InputError(
            table.source, whole,
            fmt::format("stands in two of the {} documents that the file holds, one behind the other, with "
                        "other numbers: keep one calibration",
                        documents.size()));
      check_count(table);
    }
}

void parse_yaml(const std::string& text, NumberTable& table) {
  const auto documents = detail::documents_of(as_yaml(text));
  if (documents.size() > 1) return merge_documents(documents, table);
  table.entries = table_of(documents[0], table.source).entries;
}

bool is_opencv_xml(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<' && text.find("<opencv_storage") != std::string::npos;
}

/// A matrix has its numbers in its child `data`, a list in children `_`, a number or a size in its own text.
void append_xml_numbers(const pugi::xml_node& node, NumberEntry& entry) {
  const pugi::xml_node data = node.child("data") ? node.child("data") : node;
  if (detail::is_opencv_base64(data.child_value(), data.attribute("type_id").value()))
    detail::append_opencv_base64(data.child_value(), entry);
  else
    append_words(entry, data.child_value());
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
    throw InputError(source, std::string(key),
                     fmt::format("found {} number{}, expected {}{}", numbers.size(), numbers.size() == 1 ? "" : "s",
                                 count, hint_of_decimal_commas(numbers, count)));
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

std::string hint_of_decimal_commas(const std::vector<double>& numbers, std::size_t expected) {
  const auto is_whole = [](double number) { return number == std::floor(number); };
  std::size_t halved = 0;
  for (std::size_t i = 0; i + 1 < numbers.size(); ++i)
    if (is_whole(numbers[i]) && is_whole(numbers[i + 1]) && numbers[i + 1] >= 0.0) {
      ++halved;
      ++i;
    }
  if (numbers.size() <= expected || numbers.size() > expected + halved) return "";
  return " (is a comma meant as a decimal point? write a point)";
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
