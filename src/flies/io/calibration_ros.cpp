// The YAML formats with one entry a number or a camera: our own plain one, and ROS camera_info.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/name_hint.hpp"
#include "flies/core/options.hpp"
#include "flies/io/formats/distortion_names.hpp"
#include "flies/io/formats/quantities.hpp"
#include "flies/io/formats/raw_pair.hpp"
#include "flies/io/formats/second_file.hpp"
#include "flies/io/formats/sides.hpp"

namespace flies::detail {
namespace {

const std::vector<std::string> kPlainKeys = {"fx_px",    "fy_px",      "cx_px",    "cx_right_px",
                                             "cy_px",    "baseline_m", "width_px", "height_px",
                                             "height_m", "pitch_deg",  "roll_deg"};

Calibration read_plain(const NumberTable& table, const CalibrationRequest& request) {
  for (const auto& [key, entry] : table.entries)
    if (std::find(kPlainKeys.begin(), kPlainKeys.end(), key) == kPlainKeys.end())
      throw InputError(table.source, key, "unknown key" + did_you_mean(key, kPlainKeys));
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
  camera.baseline_m = table.has("baseline_m") ? table.require_number("baseline_m")
                                              : missing_baseline(request, table.source, "baseline_m");
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

bool is_zero(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double number) { return number == 0.0; });
}

/// One camera of a ROS file: the projection matrix and the image size, below `prefix`.
struct RosCamera : RosCameraKeys {
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
  /// Drivers of cameras that bend nothing leave the list empty.
  std::vector<double> distortion(Lens lens) const {
    const auto key = first_key({"distortion_coefficients", "D", "d"});
    const bool is_empty = key && table.entries.find(*key)->second.numbers.empty();
    return is_empty ? std::vector<double>() : distortion_of(table, prefix, lens);
  }
  RectifiedView view(CalibrationNotes& notes) const {
    RectifiedView view;
    view.camera.matrix = matrix_of(table, key("camera_matrix", "K", "k"));
    const std::string model_key = prefix + "distortion_model";
    view.camera.lens = lens_of(table.word(model_key), model_key, table.source);
    view.camera.distortion = distortion(view.camera.lens);
    view.rotation = rotation_of(table, key("rectification_matrix", "R", "r"), notes);
    if (is_zero(view.rotation)) view.rotation = Pose{}.rotation;  // drivers leave it out of cameras that need none
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
    return std::ranges::any_of(table.entries, [&](const auto& item) {
      return item.first.starts_with(prefix) && holds_distortion(item.first, item.second);
    });
  }
  /// @throws InputError when it is a camera that nobody calibrated, of which ROS has zeros
  void check_calibrated() const {
    const auto [own_table, key] = projection();
    if (is_zero(own_table.require(key, 12)))
      throw InputError(own_table.source, key,
                       "holds only zeros: the camera is not calibrated; calibrate both cameras, or give their "
                       "calibration with --calib");
  }
};

/// A window of the images that a message says in `roi`: of the whole images' pixels, as all other numbers are.
struct Window {
  double x_px = 0.0, y_px = 0.0;
  int width_px = 0, height_px = 0;
};

std::optional<Window> window_of(const RosCamera& camera) {
  const auto number = [&](const char* name) {
    const std::string key = camera.prefix + name;
    return camera.table.has(key) ? camera.table.require_number(key) : 0.0;
  };
  if (number("roi.width") == 0.0 || number("roi.height") == 0.0) return std::nullopt;  // ROS: the whole image
  const Window window{number("roi.x_offset"), number("roi.y_offset"), camera.size_px({"roi.width"}),
                      camera.size_px({"roi.height"})};
  if (window.width_px == camera.width_px() && window.height_px == camera.height_px()) return std::nullopt;
  return window;
}

/// Whether images of that size show the window, be it binned, rather than the whole.
bool shows(const Window& window, const RosCamera& camera, const CalibrationRequest& request) {
  const auto bins = [&](const char* name) {
    constexpr double kMost = 64.0;
    const std::string key = camera.prefix + name;
    const double found = camera.table.has(key) ? camera.table.require_number(key) : 0.0;  // which means 1
    return static_cast<int>(std::clamp(found, 1.0, kMost));
  };
  if (request.width_px == window.width_px / bins("binning_x") &&
      request.height_px == window.height_px / bins("binning_y"))
    return true;
  const auto fits = [&](int width_px, int height_px) {
    return one_scale(width_px, height_px, request.width_px, request.height_px).has_value();
  };
  return fits(window.width_px, window.height_px) && !fits(camera.width_px(), camera.height_px());
}

/// The numbers for the images at hand, where these are the window that the message says.
/// @param prefix of the camera
NumberTable windowed(const NumberTable& table, const std::string& prefix, const CalibrationRequest& request,
                     CalibrationNotes& notes) {
  const RosCamera camera{{table, prefix}};
  const auto window = window_of(camera);
  if (!window) return table;
  const auto place = fmt::format("a window of {} x {} px at column {}, row {}", window->width_px, window->height_px,
                                 window->x_px, window->y_px);
  if (!shows(*window, camera, request)) {
    if (request.width_px != camera.width_px() || request.height_px != camera.height_px())
      notes.push_back({fmt::format("{}roi, {}, is ignored: it is for images of that size", prefix, place)});
    return table;
  }
  notes.push_back({fmt::format("{}roi is read as {}, which is what the images show: cx and cy are counted within it",
                               prefix, place),
                   CalibrationNoteKind::told});
  NumberTable shifted = table;
  const auto numbers = [&](std::initializer_list<const char*> names) -> std::vector<double>* {
    const auto key = camera.first_key(names);
    return key ? &shifted.entries.find(*key)->second.numbers : nullptr;
  };
  const auto shift = [&](std::vector<double>* matrix, std::size_t columns) {
    if (matrix == nullptr || matrix->size() != 3 * columns) return;
    (*matrix)[2] -= window->x_px;
    (*matrix)[columns + 2] -= window->y_px;
  };
  shift(numbers({"projection_matrix", "P", "p"}), 4);
  shift(numbers({"camera_matrix", "K", "k"}), 3);
  if (auto* width = numbers({"image_width", "width"})) *width = {static_cast<double>(window->width_px)};
  if (auto* height = numbers({"image_height", "height"})) *height = {static_cast<double>(window->height_px)};
  return shifted;
}

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
        {"the images are taken as rectified (image_rect); the distortion coefficients are ignored (give --raw if the "
         "images are as the cameras gave them, image_raw)",
         CalibrationNoteKind::told});
  return calibration;
}

/// Whether two cameras see as from one place: each was calibrated alone, so that nothing says how far they are apart.
bool are_in_one_place(const RectifiedView& left, const RectifiedView& right) {
  const auto& a = left.projection;
  const auto& b = right.projection;
  return a[3] / a[0] == b[3] / b[0] && a[7] / a[5] == b[7] / b[5];
}

/// @throws InputError when it is not above 0; naming the right camera's projection unless the user says it
double baseline_of_the_user(const CalibrationRequest& request, const RosCamera& right) {
  if (request.baseline_m) {
    check_asked_baseline(*request.baseline_m, right.table.source);
    return *request.baseline_m;
  }
  throw InputError(right.table.source, right.projection().key,
                   "says that both cameras are in the same place, as if each was calibrated alone: give the distance "
                   "between them (--baseline M)");
}

/// Of images as the cameras gave them: the file says how each of them is rectified, and so where the other stands.
Calibration read_raw_ros_pair(const RosCamera& left, const RosCamera& right, const CalibrationRequest& request) {
  check_same_size_of(left, right);
  RawPair pair{{},
               left.key("camera_matrix", "K", "k"),
               right.key("camera_matrix", "K", "k"),
               left.key("rectification_matrix", "R", "r")};
  const auto left_view = left.view(pair.notes);
  auto right_view = right.view(pair.notes);
  if (are_in_one_place(left_view, right_view)) {
    const double baseline_m = baseline_of_the_user(request, right);
    right_view.projection[3] -= baseline_m * right_view.projection[0];
    pair.notes.push_back(
        {fmt::format("{} says that both cameras are in the same place, as if each was calibrated alone: they are taken "
                     "as {:.4g} m apart, as given, and turned as R says",
                     right.projection().key, baseline_m)});
  }
  pair.stereo.left = left_view.camera;
  pair.stereo.right = right_view.camera;
  set_pose(pair.stereo, pose_of_views(left_view, right_view));
  pair.stereo.width_px = left.width_px();
  pair.stereo.height_px = left.height_px();
  return calibration_from_raw(std::move(pair), request, left.table.source);
}

/// What stands before the keys of the left and of the right camera.
using Prefixes = std::array<std::string, 2>;

/// Messages of both cameras, one after the other, in a list or below their topics; files with OpenCV's names say less
/// of each.
std::optional<Prefixes> messages_in(const NumberTable& table) {
  std::vector<std::string> cameras;
  for (const auto& [key, entry] : table.entries) {
    const std::string prefix = key.substr(0, key.rfind('.') + 1);
    const auto has = [&](const char* name) { return table.has(prefix + name); };
    const bool is_projection = !prefix.empty() && (key == prefix + "P" || key == prefix + "p");
    if (is_projection && has("width") && has("distortion_model") && (has("K") || has("k")) && (has("R") || has("r")))
      cameras.push_back(prefix);
  }
  std::vector<Prefixes> pairs;
  for (const auto& left : cameras)
    for (const auto& right : cameras)
      if (is_left_and_right(left, right)) pairs.push_back({left, right});
  return pairs.size() == 1 ? std::optional(pairs[0]) : std::nullopt;
}

Calibration read_ros(const NumberTable& table, const CalibrationRequest& request) {
  const auto messages = messages_in(table);
  const bool is_one_file =
      table.has("left.projection_matrix") || table.has("right.projection_matrix") || messages.has_value();
  const Prefixes prefixes = messages ? *messages : is_one_file ? Prefixes{"left.", "right."} : Prefixes{};
  const NumberTable right = is_one_file ? table : read_right_file(table, request);
  auto calibration = calibration_from_ros({table, prefixes[0]}, {right, prefixes[1]}, request);
  if (!is_one_file) {
    calibration.left_name = table.source;
    calibration.right_name = right.source;
  }
  return calibration;
}

}  // namespace

Calibration calibration_from_ros(const RosCameraKeys& left, const RosCameraKeys& right,
                                 const CalibrationRequest& request) {
  for (const auto& keys : {left, right}) RosCamera{keys}.check_calibrated();
  CalibrationNotes notes, notes_of_right;  // which say the same
  const NumberTable left_table = windowed(left.table, left.prefix, request, notes);
  const NumberTable right_table = windowed(right.table, right.prefix, request, notes_of_right);
  const auto read = request.images_are_raw ? read_raw_ros_pair : read_ros_pair;
  auto calibration = read({{left_table, left.prefix}}, {{right_table, right.prefix}}, request);
  calibration.notes.insert(calibration.notes.begin(), notes.begin(), notes.end());
  return calibration;
}

const CalibrationFormat kPlainYaml{
    "flies YAML", false, false,
    [](const NumberTable& table) {
      // Programs that write matrices may add a baseline for who reads them.
      const bool has_matrices = std::ranges::any_of(
          table.entries, [](const auto& key_and_entry) { return key_and_entry.second.numbers.size() > 1; });
      return table.has("fx_px") ||
             (!has_matrices && !has_camera(table) && (table.has("baseline_m") || table.has("cx_px")));
    },
    read_plain};

const CalibrationFormat kRosCameraInfo{"ROS camera_info pair", false, true,
                                       [](const NumberTable& table) {
                                         return table.has("projection_matrix") || table.has("left.projection_matrix") ||
                                                table.has("right.projection_matrix") ||
                                                messages_in(table).has_value() || (table.has("P") && table.has("K")) ||
                                                (table.has("p") && table.has("k"));
                                       },
                                       read_ros};

}  // namespace flies::detail
