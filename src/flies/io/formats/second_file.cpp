#include "flies/io/formats/second_file.hpp"

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

#include "flies/core/error.hpp"

namespace fs = std::filesystem;

namespace flies::detail {
namespace {

/// "left.yaml" -> "right.yaml".
std::optional<std::string> right_name(const std::string& left) {
  constexpr std::array<std::array<std::string_view, 2>, 5> kNames = {
      {{"left", "right"}, {"Left", "Right"}, {"LEFT", "RIGHT"}, {"cam0", "cam1"}, {"cam_0", "cam_1"}}};
  for (const auto& [left_name, right_name] : kNames) {
    const auto at = left.rfind(left_name);
    if (at != std::string::npos) return std::string(left).replace(at, left_name.size(), right_name);
  }
  return std::nullopt;
}

}  // namespace

std::optional<fs::path> right_file_beside(const fs::path& left) {
  if (const auto name = right_name(left.filename().string())) return left.parent_path() / *name;
  const fs::path folder = fs::absolute(left).parent_path();
  if (const auto name = right_name(folder.filename().string())) return folder.parent_path() / *name / left.filename();
  return std::nullopt;
}

NumberTable read_right_file(const NumberTable& left, const CalibrationRequest& request) {
  if (!request.right_path.empty()) return read_number_table(request.right_path);
  const auto beside = right_file_beside(left.source);
  std::error_code ignored;
  if (left.is_cut_off && (!beside || !fs::exists(*beside, ignored)))
    throw InputError(left.source, "right camera",
                     "is missing: the message behind the first one is cut off: print both to their end, or each to a "
                     "file of its own");
  if (!beside || !fs::exists(*beside, ignored))
    throw InputError(left.source, "right camera",
                     beside ? fmt::format("is missing: there is no {}", beside->string())
                            : std::string("is missing: this file describes one camera; give the file of the other"));
  return read_number_table(beside->string());
}

}  // namespace flies::detail
