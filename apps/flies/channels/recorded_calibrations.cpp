#include "channels/recorded_calibrations.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "channels/recorded_topics.hpp"
#include "flies/core/error.hpp"

namespace {

using Json = nlohmann::json;

/// Zeros are ROS's mark of a camera that is not calibrated.
bool is_calibrated(const flies::RosCameraInfo& info) { return info.intrinsics[0] != 0.0 || info.projection[0] != 0.0; }

/// The fields in which two messages differ.
std::vector<std::string> differences(const flies::RosCameraInfo& a, const flies::RosCameraInfo& b) {
  std::vector<std::string> fields;
  const auto compare = [&](const char* field, bool is_same) {
    if (!is_same) fields.emplace_back(field);
  };
  compare("K", a.intrinsics == b.intrinsics);
  compare("D", a.distortion == b.distortion && a.distortion_model == b.distortion_model);
  compare("R", a.rectification == b.rectification);
  compare("P", a.projection == b.projection);
  compare("size", a.width_px == b.width_px && a.height_px == b.height_px);
  compare("binning", a.binning_x == b.binning_x && a.binning_y == b.binning_y);
  compare("roi", a.window == b.window);
  return fields;
}

template <std::size_t N>
void fill(std::array<double, N>& numbers, const Json& json, const char* field, const std::string& name) {
  if (!json.contains(field)) return;
  const auto found = json[field].get<std::vector<double>>();
  if (found.size() != N)
    throw flies::InputError(name, field, fmt::format("found {} numbers, expected {}", found.size(), N));
  std::ranges::copy(found, numbers.begin());
}

}  // namespace

void RecordedCalibrations::read_ros(const flies::RecordedMessage& message, const std::string& name) {
  seen_.insert(message.topic);
  add(flies::ros_camera_info(message, name));
}

void RecordedCalibrations::read_foxglove(const flies::RecordedMessage& message, const std::string& name) {
  seen_.insert(message.topic);
  flies::RosCameraInfo info;
  info.topic = message.topic;
  try {
    const Json json = Json::parse(message.data);
    info.width_px = json.value("width", 0);
    info.height_px = json.value("height", 0);
    info.distortion_model = json.value("distortion_model", "");
    info.distortion = json.value("D", std::vector<double>());
    fill(info.intrinsics, json, "K", name);
    fill(info.rectification, json, "R", name);
    fill(info.projection, json, "P", name);
  } catch (const Json::exception&) {
    throw flies::InputError(name, "", "a message does not match its schema");
  }
  add(std::move(info));
}

void RecordedCalibrations::add(flies::RosCameraInfo info) {
  const auto [found, is_new] = by_topic_.try_emplace(info.topic, OfTopic{info, std::nullopt});
  auto& [first, other] = found->second;
  if (is_new || other || !is_calibrated(info)) return;
  if (!is_calibrated(first))
    first = std::move(info);
  else if (!differences(first, info).empty())
    other = std::move(info);
}

std::string RecordedCalibrations::topic_of(const std::string& pictures) const {
  std::string usual = camera_info_topic(pictures);
  const std::string folder = usual.substr(0, usual.rfind('/') + 1);
  for (const auto& topic : {usual, folder + "calibration", pictures + "/camera_info", pictures + "/calibration"})
    if (seen_.contains(topic)) return topic;
  return usual;
}

const flies::RosCameraInfo* RecordedCalibrations::find(const std::string& topic) const {
  const auto found = by_topic_.find(topic);
  return found == by_topic_.end() ? nullptr : &found->second.first;
}

std::vector<std::string> RecordedCalibrations::topics() const {
  std::vector<std::string> names;
  for (const auto& [topic, messages] : by_topic_) names.push_back(topic);
  return names;
}

std::optional<std::string> RecordedCalibrations::change_note(const std::string& topic) const {
  const auto found = by_topic_.find(topic);
  if (found == by_topic_.end() || !found->second.other) return std::nullopt;
  const auto& [first, other] = found->second;
  return fmt::format(
      "{} changes during the recording: {} (focal length {:g} px, then {:g} px); the first is used for all pairs, and "
      "the ranges of later ones may be wrong",
      topic, fmt::join(differences(first, *other), ", "), first.projection[0], other->projection[0]);
}
