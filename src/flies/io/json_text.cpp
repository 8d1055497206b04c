#include "flies/io/json_text.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

namespace flies::detail {
namespace {

constexpr std::string_view kBlanks = " \t\n";

bool is_any_of(std::string_view letters, char letter) { return letters.find(letter) != std::string_view::npos; }

/// The end of the comment that begins here; `at` where none does. `http://`, `a/*` and `a#b` are words.
std::size_t end_of_comment(std::string_view text, std::size_t at) {
  const std::string_view rest = text.substr(at);
  const char before = at == 0 ? '\n' : text[at - 1];
  if (rest.starts_with("/*") && std::isalpha(static_cast<unsigned char>(before)) == 0) {
    const auto end = rest.find("*/", 2);
    return end == std::string_view::npos ? text.size() : at + end + 2;
  }
  const bool is_comment =
      (rest.starts_with("//") && before != ':') || (rest.starts_with('#') && is_any_of(kBlanks, before));
  return is_comment ? at + std::min(rest.find('\n'), rest.size()) : at;
}

/// The end of the quoted word that begins here; that of the text where it does not end.
std::size_t end_of_quotes(std::string_view text, std::size_t at) {
  const char quote = text[at];
  for (std::size_t i = at + 1; i < text.size(); ++i) {
    if (text[i] == quote) return i + 1;
    i += text[i] == '\\' && quote == '"';
  }
  return text.size();
}

/// Whether a list or map is one of YAML's keys, by what stands behind it.
bool is_key(std::string_view behind) {
  const auto next = behind.find_first_not_of(' ');
  return next != std::string_view::npos && behind[next] == ':';
}

/// Blanks instead of letters; the ends of lines stay, as errors name lines.
std::string blanked(std::string_view comment) {
  std::string blanks(comment);
  std::replace_if(
      blanks.begin(), blanks.end(), [](char letter) { return letter != '\n'; }, ' ');
  return blanks;
}

}  // namespace

bool is_json_text(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = is_any_of(kBlanks, text[at]) ? at + 1 : end_of_comment(text, at);
    if (end == at) return is_any_of("{[", text[at]);
    at = end;
  }
  return false;
}

std::vector<std::string> json_values_of(std::string_view text) {
  std::vector<std::string> values;
  std::string value;
  int depth = 0;
  char before = ',';  // the last letter that is no blank
  for (std::size_t i = 0; i < text.size();) {
    if (const std::size_t end = end_of_comment(text, i); end > i) {
      value += blanked(text.substr(i, end - i));
      i = end;
      continue;
    }
    const char letter = text[i];
    const bool is_quoted = is_any_of("\"'", letter) && is_any_of(",:[{", before);  // elsewhere it is an apostrophe
    const std::size_t end = is_quoted ? end_of_quotes(text, i) : i + 1;
    value += text.substr(i, end - i);
    i = end;
    if (!is_any_of(kBlanks, letter)) before = letter;
    depth += is_any_of("{[", letter);
    depth -= is_any_of("}]", letter);
    if (depth == 0 && is_any_of("}]", letter) && !is_key(text.substr(i))) values.push_back(std::exchange(value, ""));
  }
  if (value.find_first_not_of(kBlanks) != std::string::npos) values.push_back(std::move(value));
  for (auto& yaml : values) std::replace(yaml.begin(), yaml.end(), '\t', ' ');
  return values;
}

}  // namespace flies::detail
