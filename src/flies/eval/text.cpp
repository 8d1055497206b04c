#include "flies/eval/text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <sstream>

#include "flies/core/convert.hpp"
#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/io/text_file.hpp"

namespace flies::detail {

std::string read_truth(const std::filesystem::path& path) {
  constexpr std::size_t kMax_bytes = std::size_t{1} << 30;
  return read_bytes(path.string(), kMax_bytes);
}

double parse_number(std::string_view text, const std::string& source, const std::string& field) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw InputError(source, field, fmt::format("found \"{}\", expected a number", text));
  }
  check_number(value, source, field);
  return value;
}

int parse_whole_number(std::string_view text, const std::string& source, const std::string& field) {
  const auto number = whole_number<int>(parse_number(text, source, field));
  if (!number) throw InputError(source, field, fmt::format("found \"{}\", expected a whole number", text));
  return *number;
}

void check_number(double value, const std::string& source, const std::string& field) {
  if (!(std::abs(value) <= kMaxNumber))
    throw InputError(source, field, fmt::format("found {}, expected a number within +-{}", value, kMaxNumber));
}

std::vector<TextLine> lines_of(std::string_view text) {
  std::vector<TextLine> lines;
  std::istringstream stream{plain_text(std::string(text))};
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::string_view content = trimmed(line);
    if (!content.empty() && content.front() != '#') lines.push_back({number, std::string(content)});
  }
  return lines;
}

}  // namespace flies::detail
