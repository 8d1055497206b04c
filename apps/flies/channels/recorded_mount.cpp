#include "channels/recorded_mount.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "channels/channels.hpp"
#include "flies/core/error.hpp"

namespace {

using Json = nlohmann::json;

/// The turn from the camera's axes to the vehicle's, as `camera_transform` of the channels builds it.
flies::CameraMount mount_of(const Json& transform) {
  const Json& q = transform.at("rotation");
  const double x = q.at("x"), y = q.at("y"), z = q.at("z"), w = q.at("w");
  const double forward_z = 1.0 - 2.0 * (x * x + y * y);  // of the camera's forward axis
  const double right_z = 2.0 * (x * z - w * y);          // and of its right axis, how far they point up
  flies::CameraMount mount;
  mount.height_m = transform.at("translation").at("z");
  mount.pitch_rad = -std::asin(std::clamp(forward_z, -1.0, 1.0));
  mount.roll_rad = -std::asin(std::clamp(right_z / std::cos(mount.pitch_rad), -1.0, 1.0));
  return mount;
}

/// Smaller changes move nothing that is found.
constexpr double kSame_m = 0.01, kSame_deg = 0.05;

double rounded(double value) { return std::round(100.0 * value) / 100.0 + 0.0; }

std::string in_words(const flies::CameraMount& mount) {
  return fmt::format("{:g} m high, {:g} degrees down and {:g} to the right", rounded(mount.height_m),
                     rounded(flies::degrees(mount.pitch_rad)), rounded(flies::degrees(mount.roll_rad)));
}

bool are_alike(const flies::CameraMount& a, const flies::CameraMount& b) {
  return std::abs(a.height_m - b.height_m) < kSame_m &&
         flies::degrees(std::abs(a.pitch_rad - b.pitch_rad)) < kSame_deg &&
         flies::degrees(std::abs(a.roll_rad - b.roll_rad)) < kSame_deg;
}

}  // namespace

void RecordedMount::read(const flies::RecordedMessage& message, const std::string& path) {
  if (message.topic != topic_of(Channel::camera_transform) || other_) return;
  try {
    const flies::CameraMount mount = mount_of(Json::parse(message.data));
    if (!first_)
      first_ = mount;
    else if (!are_alike(*first_, mount))
      other_ = mount;
  } catch (const Json::exception&) {
    is_damaged_ = true;
    throw flies::InputError(path, message.topic, "a message does not match its schema");
  }
}

std::optional<std::string> RecordedMount::note() const {
  if (is_damaged_ && !first_) return "the recording is damaged where it says how the camera is mounted";
  if (!other_) return std::nullopt;
  return fmt::format(
      "the mount of the camera changes during the recording ({}; then {}): the first is used for all pairs",
      in_words(*first_), in_words(*other_));
}
