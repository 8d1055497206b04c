#include "channels/own_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/calibration_formats.hpp"

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

}  // namespace

std::string_view topic_of(Channel channel) { return kChannels[static_cast<std::size_t>(channel)].topic; }

void OwnCalibration::read(const flies::RecordedMessage& message, const std::string& path) {
  const bool is_left = message.topic == topic_of(Channel::left_calibration);
  const bool is_right = message.topic == topic_of(Channel::right_calibration);
  const bool is_mount = message.topic == topic_of(Channel::camera_transform);
  if ((!is_left || has_left_) && (!is_right || has_right_) && (!is_mount || has_mount_)) return;
  has_unreadable_mount_ |= is_mount;  // until it was read
  try {
    const Json json = Json::parse(message.data);
    if (is_mount) {
      camera_.mount = mount_of(json);
      has_mount_ = true;
      has_unreadable_mount_ = false;
      return;
    }
    const auto projection = json.at("P").get<std::vector<double>>();
    constexpr std::size_t kNumbers = 12;
    if (projection.size() != kNumbers)
      throw flies::InputError(path, message.topic + " P",
                              fmt::format("found {} numbers, expected 12", projection.size()));
    if (is_left) {
      camera_.fx_px = projection[0];
      camera_.fy_px = projection[5];
      camera_.cx_px = projection[2];
      camera_.cy_px = projection[6];
      camera_.width_px = json.at("width");
      camera_.height_px = json.at("height");
      has_left_ = true;
    } else {
      camera_.cx_right_px = projection[2];
      camera_.baseline_m = -projection[3] / projection[0];
      has_right_ = true;
    }
  } catch (const Json::exception&) {
    throw flies::InputError(path, message.topic, "a message does not match its schema");
  }
}

std::optional<std::string> OwnCalibration::missing_topic() const {
  if (has_left_ && has_right_) return std::nullopt;
  return std::string(topic_of(has_left_ ? Channel::right_calibration : Channel::left_calibration));
}

flies::Calibration OwnCalibration::calibration(const flies::CalibrationRequest& request,
                                               const std::string& path) const {
  flies::Calibration calibration;
  calibration.camera = camera_;
  calibration.format = "recording";
  calibration.has_height = calibration.has_pitch = has_mount_;
  if (has_unreadable_mount_)
    calibration.notes.push_back(
        {"the recording is damaged where it says how the camera is mounted", flies::CalibrationNoteKind::mount});
  return flies::detail::completed(std::move(calibration), request, path);
}
