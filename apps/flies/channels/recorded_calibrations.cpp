#include "channels/recorded_calibrations.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <utility>

#include "channels/recorded_topics.hpp"
#include "flies/core/error.hpp"

namespace {

using Json = nlohmann::json;

/// Zeros are ROS's mark of a camera that is not calibrated.
bool is_calibrated(const flies::RosCameraInfo& info) { return info.intrinsics[0] != 0.0 || info.projection[0] != 0.0; }

/// No number is the same as no number.
bool is_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// In as few digits as tell them apart.
std::string both(double a, double b) {
  const std::string first = fmt::format("{:g}", a), then = fmt::format("{:g}", b);
  return first == then ? fmt::format("({}, then {})", a, b) : fmt::format("({}, then {})", first, then);
}

/// The entries in which two messages differ, with what they were and became.
std::vector<std::string> differences(const flies::RosCameraInfo& a, const flies::RosCameraInfo& b) {
  using Names = std::span<const std::string_view>;
  constexpr std::array<std::string_view, 9> kIntrinsics = {"fx", "skew", "cx", "", "fy", "cy", "", "", ""};
  constexpr std::array<std::string_view, 12> kProjection = {"fx", "skew", "cx", "Tx", "", "fy", "cy", "Ty"};
  std::vector<std::string> entries;
  const auto compare = [&](const char* field, std::span<const double> was, std::span<const double> is, Names names) {
    if (was.size() != is.size())
      entries.push_back(fmt::format("{} ({} numbers, then {})", field, was.size(), is.size()));
    for (std::size_t i = 0; i < std::min(was.size(), is.size()); ++i) {
      if (is_same(was[i], is[i])) continue;
      const bool has_name = i < names.size() && !names[i].empty();
      const auto entry = has_name ? fmt::format("{} in {}", names[i], field) : fmt::format("{}[{}]", field, i);
      entries.push_back(entry + " " + both(was[i], is[i]));
    }
  };
  const auto compare_pixels = [&](const char* field, int was, int is) {
    if (was != is) entries.push_back(fmt::format("{} ({}, then {})", field, was, is));
  };
  compare("K", a.intrinsics, b.intrinsics, kIntrinsics);
  compare("P", a.projection, b.projection, kProjection);
  if (a.distortion_model != b.distortion_model)
    entries.push_back(fmt::format("distortion_model ('{}', then '{}')", a.distortion_model, b.distortion_model));
  compare("D", a.distortion, b.distortion, {});
  compare("R", a.rectification, b.rectification, {});
  compare_pixels("width", a.width_px, b.width_px);
  compare_pixels("height", a.height_px, b.height_px);
  compare_pixels("binning_x", a.binning_x, b.binning_x);
  compare_pixels("binning_y", a.binning_y, b.binning_y);
  compare_pixels("roi.x_offset", a.window.x_px, b.window.x_px);
  compare_pixels("roi.y_offset", a.window.y_px, b.window.y_px);
  compare_pixels("roi.width", a.window.width_px, b.window.width_px);
  compare_pixels("roi.height", a.window.height_px, b.window.height_px);
  return entries;
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

std::optional<std::string> RecordedCalibrations::topic_of(const std::string& pictures) const {
  const std::string usual = camera_info_topic(pictures);
  const std::string folder = usual.substr(0, usual.rfind('/') + 1);
  for (const auto& topic : {pictures + "/camera_info", pictures + "/calibration", usual, folder + "calibration"})
    if (seen_.contains(topic)) return topic;
  return std::nullopt;
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
  constexpr std::size_t kMostNamed = 3;
  auto entries = differences(found->second.first, *found->second.other);
  if (const std::size_t count = entries.size(); count > kMostNamed) {
    entries.resize(kMostNamed);
    entries.back() += fmt::format(" and {} more", count - kMostNamed);
  }
  return fmt::format(
      "{} changes during the recording: {}; the first is used for all pairs, and the ranges of later ones may be wrong",
      topic, fmt::join(entries, ", "));
}
