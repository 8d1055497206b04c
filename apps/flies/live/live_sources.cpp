#include "live/live_sources.hpp"

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "flies/core/error.hpp"
#include "flies/video/capture.hpp"

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kHexDigits = "0123456789abcdefABCDEF";

/// With `%20` as a space and so on.
std::string decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view digits = text.substr(i + 1 <= text.size() ? i + 1 : i, 2);
    if (text[i] == '%' && digits.size() == 2 && digits.find_first_not_of(kHexDigits) == digits.npos) {
      result += static_cast<char>(std::stoi(std::string(digits), nullptr, 16));
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

}  // namespace

std::string without_file_scheme(const std::string& source) {
  constexpr std::string_view kScheme = "file://", kHost = "localhost/";
  if (!source.starts_with(kScheme)) return source;
  std::string_view path = std::string_view(source).substr(kScheme.size());
  if (path.starts_with(kHost)) path.remove_prefix(kHost.size() - 1);
  std::error_code error;
  return fs::exists(path, error) ? std::string(path) : decoded(path);
}

std::vector<std::string> files_of_pipeline(const std::string& source) {
  constexpr std::string_view kKey = "location=";
  std::vector<std::string> files;
  if (source.find('!') == source.npos) return files;
  for (auto at = source.find(kKey); at != source.npos; at = source.find(kKey, at)) {
    at += kKey.size();
    const bool is_quoted = at < source.size() && (source[at] == '"' || source[at] == '\'');
    const auto begin = is_quoted ? at + 1 : at;
    const auto end = is_quoted ? source.find(source[at], begin) : source.find_first_of(" \t\n!", begin);
    files.push_back(without_file_scheme(source.substr(begin, end == source.npos ? end : end - begin)));
  }
  return files;
}

void check_sources_differ(const std::vector<std::string>& sources) {
  if (sources.size() != 2 || flies::source_kind(sources[0]) == flies::SourceKind::stream) return;
  std::error_code error;
  const bool is_same = sources[0] == sources[1] || fs::equivalent(sources[0], sources[1], error);
  if (!is_same || fs::is_directory(sources[0], error)) return;  // folders may hold both
  throw flies::InputError(sources[1], "",
                          "is given twice, expected the left and the right pictures from two sources (one source that "
                          "holds both is given once)");
}
