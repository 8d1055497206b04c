// The YAML formats with one entry a number or a camera: our own plain one, and ROS camera_info.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/core/options.hpp"
#include "flies/io/calibration_formats.hpp"

namespace flies::detail {
namespace {

const std::vector<std::string> kPlainKeys = {"fx_px",    "fy_px",      "cx_px",    "cx_right_px",
                                             "cy_px",    "baseline_m", "width_px", "height_px",
                                             "height_m", "pitch_deg",  "roll_deg"};

Calibration read_plain(const NumberTable& table, const CalibrationRequest&) {
  for (const auto& [key, entry] : table.entries)
    if (std::find(kPlainKeys.begin(), kPlainKeys.end(), key) == kPlainKeys.end())
      throw InputError(table.source, key,
                       fmt::format("unknown key; did you mean '{}'?", nearest_name(key, kPlainKeys)));
  const auto number_or = [&](const char* key, double otherwise) {
    return table.has(key) ? table.require_number(key) : otherwise;
  };
  Calibration calibration;
  auto& camera = calibration.camera;
  camera.fx_px = table.require_number("fx_px");
  camera.fy_px = number_or("fy_px", camera.fx_px);
  camera.cx_px = table.require_number("cx_px");
  camera.cx_right_px = number_or("cx_right_px", camera.cx_px);
  camera.cy_px = table.require_number("cy_px");
  camera.baseline_m = table.require_number("baseline_m");
  camera.width_px = table.require_size("width_px");
  camera.height_px = table.require_size("height_px");
  camera.mount.height_m = number_or("height_m", camera.mount.height_m);
  camera.mount.pitch_rad = radians(number_or("pitch_deg", 0.0));
  camera.mount.roll_rad = radians(number_or("roll_deg", 0.0));
  calibration.has_height = table.has("height_m");
  calibration.has_pitch = table.has("pitch_deg");
  calibration.left_name = "left";
  calibration.right_name = "right";
  return calibration;
}

/// One camera of a ROS file: the projection matrix and the image size, below `prefix`.
struct RosCamera {
  const NumberTable& table;
  std::string prefix;

  std::optional<std::string> first_key(std::initializer_list<const char*> names) const {
    for (const char* name : names)
      if (table.has(prefix + name)) return prefix + name;
    return std::nullopt;
  }
  /// Calibration files say projection_matrix, messages printed to a file P (ROS 1) or p (ROS 2).
  ProjectionKey projection() const {
    const auto key = first_key({"projection_matrix", "P", "p"});
    if (!key) throw InputError(table.source, prefix + "projection_matrix", "is missing");
    return {table, *key};
  }
  int size_px(std::initializer_list<const char*> names) const {
    const auto key = first_key(names);
    return key ? table.require_size(*key) : 0;
  }
  int width_px() const { return size_px({"image_width", "width"}); }
  int height_px() const { return size_px({"image_height", "height"}); }
  bool is_distorted() const {
    const auto key = first_key({"distortion_coefficients", "D", "d"});
    if (!key) return false;
    const auto& numbers = table.entries.find(*key)->second.numbers;
    return std::any_of(numbers.begin(), numbers.end(), [](double d) { return d != 0.0; });
  }
};

Calibration read_ros_pair(const RosCamera& left, const RosCamera& right) {
  auto calibration = calibration_from_projections(left.projection(), right.projection());
  if (left.width_px() != right.width_px() || left.height_px() != right.height_px())
    throw InputError(right.table.source, right.prefix + "image size",
                     fmt::format("found {} x {} px, expected {} x {} px as for the left camera", right.width_px(),
                                 right.height_px(), left.width_px(), left.height_px()));
  calibration.camera.width_px = left.width_px();
  calibration.camera.height_px = left.height_px();
  if (left.is_distorted() || right.is_distorted())
    calibration.notes.push_back(
        "the images are taken as rectified (image_rect); the distortion coefficients are ignored");
  return calibration;
}

/// "left.yaml" -> "right.yaml", in the file name only.
std::optional<std::filesystem::path> right_file_beside(const std::filesystem::path& left) {
  constexpr std::array<std::array<std::string_view, 2>, 3> kNames = {
      {{"left", "right"}, {"Left", "Right"}, {"LEFT", "RIGHT"}}};
  for (const auto& [left_name, right_name] : kNames) {
    std::string name = left.filename().string();
    const auto at = name.rfind(left_name);
    if (at == std::string::npos) continue;
    name.replace(at, left_name.size(), right_name);
    return left.parent_path() / name;
  }
  return std::nullopt;
}

Calibration read_ros(const NumberTable& table, const CalibrationRequest& request) {
  if (table.has("left.projection_matrix") || table.has("right.projection_matrix"))
    return read_ros_pair({table, "left."}, {table, "right."});
  std::string right_path = request.right_path;
  if (right_path.empty()) {
    const auto beside = right_file_beside(table.source);
    if (!beside || !std::filesystem::exists(*beside))
      throw InputError(table.source, "right camera",
                       beside ? fmt::format("is missing: there is no {}", beside->string())
                              : std::string("is missing: this file describes one camera; give the file of the other"));
    right_path = beside->string();
  }
  const auto right = read_number_table(right_path);
  auto calibration = read_ros_pair({table, ""}, {right, ""});
  calibration.left_name = table.source;
  calibration.right_name = right_path;
  return calibration;
}

}  // namespace

const CalibrationFormat kPlainYaml{
    "flies YAML", false, false,
    [](const NumberTable& table) { return table.has("fx_px") || table.has("baseline_m") || table.has("cx_px"); },
    read_plain};

const CalibrationFormat kRosCameraInfo{"ROS camera_info pair", false, true,
                                       [](const NumberTable& table) {
                                         return table.has("projection_matrix") || table.has("left.projection_matrix") ||
                                                table.has("right.projection_matrix") ||
                                                (table.has("P") && table.has("K")) ||
                                                (table.has("p") && table.has("k"));
                                       },
                                       read_ros};

}  // namespace flies::detail
