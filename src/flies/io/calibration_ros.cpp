// The YAML formats with one entry a number or a camera: our own plain one, and ROS camera_info.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/options.hpp"
#include "flies/io/formats/raw_pair.hpp"
#include "flies/io/formats/second_file.hpp"

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
  /// The first of the names that the file has; the first of all when it has none.
  std::string key(const char* of_file, const char* of_ros1, const char* of_ros2) const {
    return first_key({of_file, of_ros1, of_ros2}).value_or(prefix + of_file);
  }
  RectifiedView view(std::vector<std::string>& notes) const {
    RectifiedView view;
    view.camera.matrix = matrix_of(table, key("camera_matrix", "K", "k"));
    const std::string model_key = prefix + "distortion_model", distortion = key("distortion_coefficients", "D", "d");
    view.camera.lens = lens_of(table.word(model_key), model_key, table.source);
    if (const auto found = table.entries.find(distortion);
        found != table.entries.end() && !found->second.numbers.empty())
      view.camera.distortion = table.require(distortion);
    view.rotation = rotation_of(table, key("rectification_matrix", "R", "r"), notes);
    view.projection = table.require(projection().key, 12);
    if (view.projection[0] == 0.0 || view.projection[5] == 0.0)
      throw InputError(table.source, projection().key, "found a focal length of 0, expected a positive one");
    return view;
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

void check_same_size_of(const RosCamera& left, const RosCamera& right) {
  check_same_size({left.width_px(), left.height_px()}, {right.width_px(), right.height_px()}, right.table.source,
                  right.prefix + "image size");
}

Calibration read_ros_pair(const RosCamera& left, const RosCamera& right, const CalibrationRequest&) {
  auto calibration = calibration_from_projections(left.projection(), right.projection());
  check_same_size_of(left, right);
  calibration.camera.width_px = left.width_px();
  calibration.camera.height_px = left.height_px();
  if (left.is_distorted() || right.is_distorted())
    calibration.notes.push_back(
        "the images are taken as rectified (image_rect); the distortion coefficients are ignored (--raw: they are as "
        "the cameras gave them, image_raw)");
  return calibration;
}

/// Of images as the cameras gave them: the file says how each of them is rectified, and so where the other stands.
Calibration read_raw_ros_pair(const RosCamera& left, const RosCamera& right, const CalibrationRequest& request) {
  check_same_size_of(left, right);
  RawPair pair{{},
               left.key("camera_matrix", "K", "k"),
               right.key("camera_matrix", "K", "k"),
               left.key("rectification_matrix", "R", "r")};
  const auto left_view = left.view(pair.notes), right_view = right.view(pair.notes);
  pair.stereo.left = left_view.camera;
  pair.stereo.right = right_view.camera;
  set_pose(pair.stereo, pose_of_views(left_view, right_view));
  const auto size = known_size({left.width_px(), left.height_px()}, request, left.table.source);
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  return calibration_from_raw(std::move(pair), request, left.table.source);
}

Calibration read_ros(const NumberTable& table, const CalibrationRequest& request) {
  const auto read = request.images_are_raw ? read_raw_ros_pair : read_ros_pair;
  if (table.has("left.projection_matrix") || table.has("right.projection_matrix"))
    return read({table, "left."}, {table, "right."}, request);
  const auto right = read_right_file(table, request);
  auto calibration = read({table, ""}, {right, ""}, request);
  calibration.left_name = table.source;
  calibration.right_name = right.source;
  return calibration;
}

}  // namespace

const CalibrationFormat kPlainYaml{
    "flies YAML", false, false,
    [](const NumberTable& table) {
      // Programs that write matrices may add a baseline for who reads them.
      const bool has_matrices = std::ranges::any_of(
          table.entries, [](const auto& key_and_entry) { return key_and_entry.second.numbers.size() > 1; });
      return table.has("fx_px") || (!has_matrices && (table.has("baseline_m") || table.has("cx_px")));
    },
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
