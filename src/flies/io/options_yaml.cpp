#include "flies/io/options_yaml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/io/text_file.hpp"
#include "flies/io/yaml_text.hpp"

namespace flies {
namespace {

constexpr std::size_t kMaxBytes = 1U << 20;
constexpr int kMaxDepth = 16;
constexpr std::size_t kMaxSettings = 1000;

std::string line_source(const std::string& source, const YAML::Mark& mark) {
  return mark.is_null() ? source : fmt::format("{} line {}", source, mark.line + 1);
}

void collect(const YAML::Node& map, const std::string& prefix, const std::string& source, int depth,
             std::vector<OptionSetting>& settings) {
  for (const auto& item : map) {
    const std::string where = line_source(source, item.first.Mark());
    if (!item.first.IsScalar()) throw InputError(where, prefix, "found a key that is not a word");
    const std::string path = prefix + item.first.Scalar();
    const YAML::Node& value = item.second;
    if (value.IsMap()) {
      if (depth >= kMaxDepth) throw InputError(where, path, "is nested too deeply");
      collect(value, path + ".", source, depth + 1, settings);
      continue;
    }
    if (value.IsSequence()) throw InputError(where, path, "found a list, expected a single value");
    if (!value.IsScalar()) throw InputError(where, path, "has no value");
    const auto same = std::find_if(settings.begin(), settings.end(), [&](const auto& s) { return s.path == path; });
    if (same != settings.end()) throw InputError(where, path, fmt::format("is set twice, first in {}", same->source));
    if (settings.size() >= kMaxSettings) throw InputError(where, path, "is one option too many for one file");
    settings.push_back({path, value.Scalar(), where});
  }
}

std::vector<std::string_view> split_path(std::string_view path) {
  std::vector<std::string_view> parts;
  for (std::size_t dot = path.find('.'); dot != std::string_view::npos; dot = path.find('.')) {
    parts.push_back(path.substr(0, dot));
    path.remove_prefix(dot + 1);
  }
  parts.push_back(path);
  return parts;
}

}  // namespace

std::vector<OptionSetting> parse_options_yaml(const std::string& text, const std::string& source) {
  std::vector<OptionSetting> settings;
  const YAML::Node root = detail::load_yaml(text, source);
  if (!root.IsNull() && !root.IsMap())
    throw InputError(line_source(source, root.Mark()), "", "expected options as 'name: value' lines");
  collect(root, "", source, 0, settings);
  return settings;
}

std::vector<OptionSetting> load_options_yaml(const std::string& path) {
  return parse_options_yaml(plain_text(read_file(path, kMaxBytes)), path);
}

std::string options_yaml(std::span<const OptionListing> listings) {
  std::string yaml;
  std::vector<std::string_view> open;  // the maps that the last line stands in
  for (const auto& listing : listings) {
    auto parts = split_path(listing.path);
    const std::string_view name = parts.back();
    parts.pop_back();
    const auto [same, ignored] = std::mismatch(open.begin(), open.end(), parts.begin(), parts.end());
    for (std::size_t depth = static_cast<std::size_t>(same - open.begin()); depth < parts.size(); ++depth)
      yaml += fmt::format("{}{}:\n", std::string(2 * depth, ' '), parts[depth]);
    open = parts;
    yaml += fmt::format("{}{}: {}  # {} ({})\n", std::string(2 * parts.size(), ' '), name, listing.value,
                        listing.meaning, listing.allowed);
  }
  return yaml;
}

}  // namespace flies
