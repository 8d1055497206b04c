#include "flies/eval/scene_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "flies/core/convert.hpp"
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

/// What a number of an object may be.
struct Bounds {
  double least = 0.0, most = std::numeric_limits<double>::infinity();
  const char* expected = "";
};
constexpr Bounds kAny{-std::numeric_limits<double>::infinity()};
constexpr Bounds kFromZero{.expected = "a number from 0"};
constexpr Bounds kShare{.most = 1.0, .expected = "a number from 0 to 1"};

/// An entry of "objects" and where it is, for errors.
struct ObjectEntry {
  const nlohmann::json& json;
  const std::string& source;
  std::string where;

  double value(const char* key, const Bounds& bounds = kAny) const {
    const double found = number(json, key, source, where);
    if (found < bounds.least || found > bounds.most)
      throw InputError(source, where + "." + key, fmt::format("found {}, expected {}", found, bounds.expected));
    return found;
  }
  double value_or(double otherwise, const char* key, const Bounds& bounds = kAny) const {
    return json.contains(key) ? value(key, bounds) : otherwise;
  }
};

/// The number of an object, which tells it apart from the others of a sequence.
std::optional<int> id_of(const ObjectEntry& entry) {
  if (!entry.json.contains("id")) return std::nullopt;
  const double found = entry.value("id");
  const auto id = whole_number<int>(found);
  if (!id || *id < 0)
    throw InputError(
        entry.source, entry.where + ".id",
        fmt::format("found {}, expected a whole number from 0 to {}", found, std::numeric_limits<int>::max()));
  return id;
}

int occlusion_level(double hidden) { return hidden < kPartlyHidden ? 0 : hidden < kLargelyHidden ? 1 : 2; }

std::optional<VehicleMoment> moment_of(const nlohmann::json& scene, const std::string& source, SceneUse use) {
  for (const char* key : {"time_s", "pose"}) {
    if (scene.contains(key)) continue;
    if (use == SceneUse::alone) return std::nullopt;
    throw InputError(source, key, "found none, expected one in each file of a sequence");
  }
  const auto& pose = scene["pose"];
  if (!pose.is_object()) throw InputError(source, "pose", "is no object, expected x_m, y_m and yaw_rad");
  return VehicleMoment{number(scene, "time_s", source, "scene"), number(pose, "x_m", source, "pose"),
                       number(pose, "y_m", source, "pose"), number(pose, "yaw_rad", source, "pose")};
}

/// @param index of the object, its number where it has none
LabelledObject object_of(const ObjectEntry& entry, std::size_t index) {
  if (!entry.json.is_object() || !entry.json.contains("class") || !entry.json["class"].is_string())
    throw InputError(entry.source, entry.where + ".class", "found none, expected a text");
  LabelledObject object;
  object.type = entry.json["class"].get<std::string>();
  const bool needs_no_finding = is_background(object.type);
  if (!object.type.empty())
    object.type[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(object.type[0])));
  object.track = id_of(entry).value_or(static_cast<int>(index));
  object.footprint = {entry.value("x_m"), entry.value("y_m"), entry.value_or(0.0, "yaw_rad"),
                      entry.value("length_m", kFromZero), entry.value("width_m", kFromZero)};
  object.bottom_z_m = entry.value_or(0.0, "z_m");
  object.height_m = entry.value("height_m", kFromZero);
  object.truncation = entry.value_or(0.0, "truncation", kShare);
  object.in_view_fraction = 1.0 - object.truncation;
  const double hidden = entry.value_or(0.0, "occlusion", kShare);
  object.occlusion = occlusion_level(hidden);
  const double visible_px = entry.value_or(kMinVisible_px, "visible_px", kFromZero);
  object.visible = !needs_no_finding && hidden < kLargelyHidden && object.truncation <= kMaxTruncation &&
                   visible_px >= kMinVisible_px;
  return object;
}

/// Tracks are told apart by the numbers of their objects.
void check_own_id(const ObjectEntry& entry, std::map<int, std::string>& owners) {
  const auto id = id_of(entry);
  if (!id) throw InputError(entry.source, entry.where + ".id", "found none, expected the object's number in all pairs");
  if (const auto [owner, is_new] = owners.emplace(*id, entry.where); !is_new)
    throw InputError(entry.source, entry.where + ".id",
                     fmt::format("found {}, which is that of {}, expected one of its own", *id, owner->second));
}

}  // namespace

FrameTruth parse_scene_truth(std::string_view text, const std::string& source, SceneUse use) {
  constexpr bool kThrows = false, kSkipsComments = true;
  const auto scene = nlohmann::json::parse(plain_text(std::string(text)), nullptr, kThrows, kSkipsComments);
  if (scene.is_discarded()) throw InputError(source, "", "not JSON");
  if (!scene.is_object() || !scene.contains("objects") || !scene["objects"].is_array()) {
    throw InputError(source, "objects", "found none, expected a list");
  }
  FrameTruth truth;
  truth.moment = moment_of(scene, source, use);
  std::map<int, std::string> owners;
  for (const auto& json : scene["objects"]) {
    const ObjectEntry entry{json, source, fmt::format("objects[{}]", truth.objects.size())};
    truth.objects.push_back(object_of(entry, truth.objects.size()));
    if (use == SceneUse::in_sequence) check_own_id(entry, owners);
  }
  return truth;
}

FrameTruth read_scene_truth(const std::filesystem::path& file, SceneUse use) {
  FrameTruth truth = parse_scene_truth(detail::read_truth(file), file.string(), use);
  truth.name = file.stem().string();
  return truth;
}

}  // namespace flies
