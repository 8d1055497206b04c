#include "flies/eval/scene_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <nlohmann/json.hpp>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/text_file.hpp"

namespace flies {
namespace {

constexpr double kPartlyHidden = 0.15, kLargelyHidden = 0.5;  // as the labels in KITTI's format are written
constexpr double kMaxTruncation = 0.5;
constexpr double kMinVisible_px = 100;  // a person at 40 m covers about 300

/// What goes on along the whole view has no place of its own that could be found.
constexpr std::array<std::string_view, 4> kBackground = {"wall", "hedge", "shelf", "kerb"};

bool is_background(std::string_view type) {
  return std::find(kBackground.begin(), kBackground.end(), type) != kBackground.end();
}

double number(const nlohmann::json& object, const char* key, const std::string& source, const std::string& where) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) {
    throw InputError(source, where + "." + key, "found none, expected a number");
  }
  detail::check_number(found->get<double>(), source, where + "." + key);
  return found->get<double>();
}

double number_or(double otherwise, const nlohmann::json& object, const char* key, const std::string& source,
                 const std::string& where) {
  return object.contains(key) ? number(object, key, source, where) : otherwise;
}

int occlusion_level(double hidden) { return hidden < kPartlyHidden ? 0 : hidden < kLargelyHidden ? 1 : 2; }

std::optional<VehicleMoment> moment_of(const nlohmann::json& scene, const std::string& source) {
  if (!scene.contains("time_s") || !scene.contains("pose")) return std::nullopt;
  const auto& pose = scene["pose"];
  if (!pose.is_object()) throw InputError(source, "pose", "is no object, expected x_m, y_m and yaw_rad");
  return VehicleMoment{number(scene, "time_s", source, "scene"), number(pose, "x_m", source, "pose"),
                       number(pose, "y_m", source, "pose"), number(pose, "yaw_rad", source, "pose")};
}

}  // namespace

FrameTruth parse_scene_truth(std::string_view text, const std::string& source) {
  constexpr bool kThrows = false, kSkipsComments = true;
  const auto scene = nlohmann::json::parse(plain_text(std::string(text)), nullptr, kThrows, kSkipsComments);
  if (scene.is_discarded()) throw InputError(source, "", "not JSON");
  if (!scene.is_object() || !scene.contains("objects") || !scene["objects"].is_array()) {
    throw InputError(source, "objects", "found none, expected a list");
  }
  FrameTruth truth;
  truth.moment = moment_of(scene, source);
  for (const auto& entry : scene["objects"]) {
    const std::string where = fmt::format("objects[{}]", truth.objects.size());
    if (!entry.is_object() || !entry.contains("class") || !entry["class"].is_string()) {
      throw InputError(source, where + ".class", "found none, expected a text");
    }
    const auto value = [&](const char* key) { return number(entry, key, source, where); };
    const auto value_or = [&](const char* key, double otherwise) {
      return number_or(otherwise, entry, key, source, where);
    };
    LabelledObject object;
    object.type = entry["class"].get<std::string>();
    const bool needs_no_finding = is_background(object.type);
    if (!object.type.empty()) {
      object.type[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(object.type[0])));
    }
    object.track = static_cast<int>(std::clamp(value_or("id", static_cast<double>(truth.objects.size())), 0.0, 1e9));
    object.footprint = {value("x_m"), value("y_m"), value_or("yaw_rad", 0.0), value("length_m"), value("width_m")};
    object.bottom_z_m = value_or("z_m", 0.0);
    object.height_m = value("height_m");
    object.truncation = value_or("truncation", 0.0);
    object.in_view_fraction = 1.0 - object.truncation;
    const double hidden = value_or("occlusion", 0.0);
    object.occlusion = occlusion_level(hidden);
    object.visible = !needs_no_finding && hidden < kLargelyHidden && object.truncation <= kMaxTruncation &&
                     value_or("visible_px", kMinVisible_px) >= kMinVisible_px;
    truth.objects.push_back(std::move(object));
  }
  return truth;
}

FrameTruth read_scene_truth(const std::filesystem::path& file) {
  FrameTruth truth = parse_scene_truth(detail::read_truth(file), file.string());
  truth.name = file.stem().string();
  return truth;
}

}  // namespace flies
