#include "flies/io/number_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"

namespace flies::detail {
namespace {

std::optional<double> parse_number(std::string_view word) {
  if (word == ".nan" || word == ".NaN" || word == ".NAN") return std::numeric_limits<double>::quiet_NaN();
  if (word == ".inf" || word == "-.inf") return std::numeric_limits<double>::infinity();
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The lines without comments and without blanks at their ends; empty ones are left out.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    const std::string content(trimmed(std::string_view(line).substr(0, line.find('#'))));
    const bool is_remark = content.starts_with(';') || content.starts_with('%') || content.starts_with("//");
    if (!content.empty() && !is_remark) lines.push_back(content);
  }
  return lines;
}

/// @returns the numbers of a line that holds nothing else
std::optional<std::vector<double>> bare_numbers(const std::string& line) {
  NumberEntry row;
  append_words(row, line);
  if (!row.not_a_number.empty() || row.numbers.empty()) return std::nullopt;
  return row.numbers;
}

/// The name in a line such as "[LEFT_CAM_HD]".
std::optional<std::string> section_name(const std::string& line) {
  if (line.size() < 3 || line.front() != '[' || line.back() != ']') return std::nullopt;
  const std::string name = line.substr(1, line.size() - 2);
  const auto is_of_a_name = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == ' '; };
  if (!std::isalpha(static_cast<unsigned char>(name[0])) || !std::all_of(name.begin(), name.end(), is_of_a_name))
    return std::nullopt;
  return name;
}

/// What stands between the quotes round all of a value, as TOML and MATLAB write words. One behind a bracket
/// transposes.
std::string unquoted(const std::string& value) {
  std::string text(trimmed(value));
  if (text.ends_with(';')) text = std::string(trimmed(std::string_view(text).substr(0, text.size() - 1)));
  const bool is_quoted = text.size() > 1 && text.front() == text.back() && (text[0] == '"' || text[0] == '\'');
  return is_quoted ? text.substr(1, text.size() - 2) : value;
}

/// The list of a key, whose rows may go on below it.
class OpenList {
 public:
  explicit OpenList(const std::string& source) : source_(source) {}
  void begin(const std::string& key, std::string_view value) {
    end();
    key_ = key;
    depth_ = 0;
    if (trimmed(value).starts_with('[')) go_on(value);
  }
  void go_on(std::string_view row) { depth_ += std::ranges::count(row, '[') - std::ranges::count(row, ']'); }
  bool is_open() const { return depth_ > 0; }
  /// @throws InputError when its bracket was not closed
  void end() const {
    if (is_open()) throw InputError(source_, key_, "found no ']' at the end of its list: was the file cut off?");
  }

 private:
  const std::string& source_;
  std::string key_;
  std::ptrdiff_t depth_ = 0;
};

/// One `key<separator>numbers` a line; rows of a matrix may go on below their key, keys stand below their section.
void parse_keyed_lines(const std::vector<std::string>& lines, char separator, NumberTable& table) {
  NumberEntry* last = nullptr;
  OpenList list(table.source);
  std::string section;
  for (const auto& line : lines) {
    if (const auto name = section_name(line)) {
      list.end();
      section = *name + ".";
      last = nullptr;
      continue;
    }
    const auto at = line.find(separator);
    if (at == std::string::npos) {
      const auto rest = bare_numbers(line);
      if (last != nullptr && rest) last->numbers.insert(last->numbers.end(), rest->begin(), rest->end());
      if (list.is_open()) list.go_on(line);
      continue;
    }
    const std::string name(trimmed(std::string_view(line).substr(0, at)));
    if (name.empty()) continue;
    const std::string key = section + name;
    if (table.has(key)) throw InputError(table.source, key, "stands in the file twice");
    last = &table.entries[key];
    append_words(*last, unquoted(line.substr(at + 1)));
    list.begin(key, std::string_view(line).substr(at + 1));
  }
  list.end();
}

/// Whether some line reads `cam0=` or `cam1=`.
bool is_middlebury(const std::vector<std::string>& lines) {
  return std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
    const auto at = line.find('=');
    const std::string key = at == std::string::npos ? "" : std::string(trimmed(std::string_view(line).substr(0, at)));
    return key == "cam0" || key == "cam1";
  });
}

/// Whether some line reads `P0: number number` or `P_rect_00: number number`, or has the numbers below it: a bare row
/// of numbers is no YAML idiom.
bool is_kitti(const std::vector<std::string>& lines) {
  bool follows_bare_key = false;
  for (const auto& line : lines) {
    const bool has_bracket = line.find('[') != std::string::npos;
    const auto is_row = [&](const std::string& text) {
      const auto numbers = bare_numbers(text);
      return !has_bracket && numbers && numbers->size() > 1;
    };
    if (std::exchange(follows_bare_key, false) && is_row(line)) return true;
    std::string_view rest = line;
    if (!rest.starts_with('P')) continue;
    rest.remove_prefix(rest.starts_with("P_rect_") ? 7 : 1);
    const auto colon = rest.find_first_not_of("0123456789");
    if (colon == 0 || colon == std::string_view::npos || rest[colon] != ':') continue;
    const std::string numbers(rest.substr(colon + 1));
    if (is_row(numbers)) return true;
    follows_bare_key = trimmed(numbers).empty();
  }
  return false;
}

bool has_sections(const std::vector<std::string>& lines) {
  return std::any_of(lines.begin(), lines.end(), [](const std::string& line) { return section_name(line); }) &&
         std::any_of(lines.begin(), lines.end(),
                     [](const std::string& line) { return line.find('=') != std::string::npos; });
}

/// What is assigned in a line of MATLAB, of a shell or of TOML: `name = numbers`, without the comment behind it.
std::optional<std::string> assignment(const std::string& line) {
  const auto at = line.find('=');
  if (at == std::string::npos) return std::nullopt;
  const std::string name(trimmed(std::string_view(line).substr(0, at)));
  const auto is_of_a_name = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '.'; };
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) || !std::ranges::all_of(name, is_of_a_name))
    return std::nullopt;
  return line.substr(0, line.find('%'));
}

/// Lines of assignments, and rows of numbers that go on with the one above.
std::vector<std::string> assignments(const std::vector<std::string>& lines) {
  std::vector<std::string> found;
  int count = 0;
  for (const auto& line : lines) {
    const auto one = assignment(line);
    if (!one && !bare_numbers(line)) return {};
    found.push_back(one.value_or(line));
    count += one.has_value();
  }
  return count > 1 ? found : std::vector<std::string>();
}

/// The lines of numbers that Bouguet's toolbox prints, as assignments: `Focal Length: fc_left = [ 533 534 ] ± [ 1 2 ]`.
/// What stands behind the bracket is how sure they are.
std::vector<std::string> printed_by_bouguet(const std::vector<std::string>& lines) {
  std::vector<std::string> found;
  for (const auto& line : lines) {
    const auto colon = line.find(':'), equals = line.find('=', std::min(colon, line.size()));
    const auto end = line.find(']', std::min(equals, line.size()));
    if (end != std::string::npos) found.emplace_back(trimmed(std::string_view(line).substr(colon + 1, end - colon)));
  }
  const bool is_known = std::ranges::any_of(found, [](const auto& line) { return line.starts_with("fc_left"); });
  return is_known ? found : std::vector<std::string>();
}

/// A table of one row below the names of its columns: `fx,fy,cx,cy` and then their numbers.
bool parse_row_below_names(const std::vector<std::string>& lines, NumberTable& table) {
  if (lines.size() != 2) return false;
  std::vector<std::string> names;
  std::istringstream heads(lines[0]);
  for (std::string name; std::getline(heads, name, ',');) names.emplace_back(trimmed(name));
  const auto is_name = [](const std::string& name) {
    return !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) &&
           std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
  };
  const auto row = bare_numbers(lines[1]);
  if (names.size() < 2 || !row || row->size() != names.size() || !std::ranges::all_of(names, is_name)) return false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (table.has(names[i])) throw InputError(table.source, names[i], "stands in the file twice");
    table.entries[names[i]].numbers = {(*row)[i]};
  }
  return true;
}

/// What ROS's camera calibrator writes as `ost.txt` and `.ini`: names and their numbers on lines of their own, the
/// parts of two cameras one after the other, each from `[image]` on. They get the names of its YAML.
bool parse_ost(const std::vector<std::string>& lines, NumberTable& table) {
  static const std::map<std::string, std::string, std::less<>> kNames = {{"width", "image_width"},
                                                                         {"height", "image_height"},
                                                                         {"camera matrix", "camera_matrix"},
                                                                         {"distortion", "distortion_coefficients"},
                                                                         {"rectification", "rectification_matrix"},
                                                                         {"projection", "projection_matrix"}};
  const auto count = [&](const char* line) { return std::count(lines.begin(), lines.end(), line); };
  const auto cameras = count("[image]");
  if (cameras < 1 || cameras > 2 || count("camera matrix") != cameras || count("projection") != cameras) return false;
  int camera = 0;
  NumberEntry* entry = nullptr;
  for (const auto& line : lines) {
    const auto name = kNames.find(line);
    if (line == "[image]") ++camera;
    if (name == kNames.end()) {
      const auto numbers = bare_numbers(line);
      if (numbers && entry != nullptr) entry->numbers.insert(entry->numbers.end(), numbers->begin(), numbers->end());
      continue;
    }
    const std::string key = (cameras == 1 ? "" : camera < 2 ? "left." : "right.") + name->second;
    if (table.has(key)) throw InputError(table.source, key, "stands in the file twice");
    entry = &table.entries[key];
  }
  return true;
}

/// Virtual KITTI's intrinsic.txt: names of columns, then a row a picture and camera, which are all alike.
bool parse_virtual_kitti(const std::vector<std::string>& lines, NumberTable& table) {
  constexpr std::array kNames = {"K[0,0]", "K[1,1]", "K[0,2]", "K[1,2]"};
  constexpr std::size_t kBefore = 2;  // frame and camera
  if (lines.size() < 2 || !lines[0].starts_with("frame cameraID K[0,0] K[1,1] K[0,2] K[1,2]")) return false;
  std::vector<double> first;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    auto row = bare_numbers(lines[i]);
    if (!row || row->size() != kBefore + kNames.size()) return false;
    row->erase(row->begin(), row->begin() + kBefore);
    if (first.empty()) first = *row;
    if (*row != first) throw InputError(table.source, fmt::format("row {}", i), "is of another camera than the first");
  }
  for (std::size_t k = 0; k < kNames.size(); ++k) table.entries[kNames[k]].numbers = {first[k]};
  return true;
}

/// Rows of 12 are the projection matrices of KITTI's odometry, without their names; others are kept as one list.
bool parse_bare_rows(const std::vector<std::string>& lines, NumberTable& table) {
  std::vector<std::vector<double>> rows;
  for (const auto& line : lines) {
    auto row = bare_numbers(line);
    if (!row) return false;
    rows.push_back(std::move(*row));
  }
  constexpr std::size_t kMostCameras = 4;
  if (rows.size() >= 2 && rows.size() <= kMostCameras + 1 &&
      std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.size() == 12; })) {
    for (std::size_t i = 0; i < rows.size(); ++i)
      table.entries[i < kMostCameras ? fmt::format("P{}", i) : "Tr"].numbers = rows[i];
    return true;
  }
  auto& all = table.entries[kBareNumbers].numbers;
  for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
  return true;
}

}  // namespace

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

bool parse_lines_of_numbers(const std::string& text, NumberTable& table) {
  const auto lines = lines_of(text);
  if (parse_ost(lines, table) || parse_virtual_kitti(lines, table) || parse_row_below_names(lines, table)) return true;
  if (is_middlebury(lines) || has_sections(lines)) {
    parse_keyed_lines(lines, '=', table);
    return true;
  }
  if (is_kitti(lines)) {
    parse_keyed_lines(lines, ':', table);
    return true;
  }
  for (const auto& found : {assignments(lines), printed_by_bouguet(lines)}) {
    if (found.empty()) continue;
    parse_keyed_lines(found, '=', table);
    return true;
  }
  return parse_bare_rows(lines, table);
}

}  // namespace flies::detail
