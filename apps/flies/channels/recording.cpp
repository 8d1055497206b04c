#include "channels/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "channels/channels.hpp"
#include "flies/classify/base64.hpp"
#include "flies/core/error.hpp"
#include "flies/io/image_codecs.hpp"
#include "flies/io/image_file.hpp"

namespace {

using Json = nlohmann::json;

std::string_view topic_of(Channel channel) { return kChannels[static_cast<std::size_t>(channel)].topic; }

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

void Recording::read_calibration(const flies::McapMessage& message) {
  const bool is_left = message.topic == topic_of(Channel::left_calibration);
  const bool is_right = message.topic == topic_of(Channel::right_calibration);
  const bool is_mount = message.topic == topic_of(Channel::camera_transform);
  if ((!is_left || has_left_) && (!is_right || has_right_) && (!is_mount || has_mount_)) return;
  try {
    const Json json = Json::parse(message.data);
    if (is_mount) {
      camera_.mount = mount_of(json);
      has_mount_ = true;
      return;
    }
    const auto projection = json.at("P").get<std::vector<double>>();
    constexpr std::size_t kNumbers = 12;
    if (projection.size() != kNumbers)
      throw flies::InputError(path_, message.topic + " P",
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
    throw flies::InputError(path_, message.topic, "a message is not what its schema says");
  }
}

Recording::Recording(const std::string& path) : path_(path), reader_(std::make_unique<flies::McapReader>(path)) {
  std::map<std::uint64_t, flies::McapPlace> left, right;
  bool is_cut_off = false;
  try {
    while (const auto message = reader_->next()) {
      if (message->encoding != "json") continue;
      if (message->topic == topic_of(Channel::left)) left[message->time_ns] = message->place;
      if (message->topic == topic_of(Channel::right)) right[message->time_ns] = message->place;
      read_calibration(*message);
    }
    is_cut_off = !reader_->is_whole();
  } catch (const flies::InputError&) {
    if (left.empty()) throw;
    is_cut_off = true;
  }
  for (const auto& [time_ns, place] : left)
    if (const auto partner = right.find(time_ns); partner != right.end())
      pairs_.push_back({time_ns, place, partner->second});
  if (pairs_.empty())
    throw flies::InputError(path, "",
                            fmt::format("holds no pairs: expected pictures of one time in {} and {}, in JSON, as "
                                        "flies live --record writes them",
                                        topic_of(Channel::left), topic_of(Channel::right)));
  if (!has_left_ || !has_right_)
    throw flies::InputError(
        path, std::string(topic_of(has_left_ ? Channel::right_calibration : Channel::left_calibration)), "is missing");
  flies::check_camera(camera_, path);
  if (is_cut_off) notes_.push_back(fmt::format("{}: is cut off or damaged after {} pairs", path, pairs_.size()));
  if (!has_mount_) notes_.push_back(path + ": does not say where the camera sits; the default mount is assumed");
}

double Recording::time_s(std::size_t pair) const {
  return 1e-9 * static_cast<double>(pairs_[pair].time_ns - pairs_.front().time_ns);
}

std::string Recording::name(std::size_t pair, bool is_right) const {
  return fmt::format("{} {} {}", path_, topic_of(is_right ? Channel::right : Channel::left), pair);
}

flies::GrayImage Recording::picture(const flies::McapPlace& place, const std::string& name) const {
  const auto message = reader_->at(place);
  const Json json = Json::parse(message.data, nullptr, false);
  const auto bytes = json.is_object() && json.contains("data") && json["data"].is_string()
                         ? flies::from_base64(json["data"].get<std::string>())
                         : std::nullopt;
  if (bytes)
    if (const auto fault = flies::detail::image_file_fault(*bytes); !fault.empty())
      throw flies::InputError(name, "", fault);
  cv::Mat pixels = bytes ? flies::decode_image(*bytes) : cv::Mat();
  if (pixels.empty() || pixels.depth() != CV_8U) throw flies::InputError(name, "", "is no picture of 8 bits");
  if (pixels.channels() > 1)
    cv::cvtColor(pixels, pixels, pixels.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  return {pixels.cols, pixels.rows, std::vector<std::uint8_t>(pixels.datastart, pixels.dataend)};
}

flies::GrayPair Recording::pair(std::size_t pair) const {
  flies::GrayPair images;
  images.left = picture(pairs_[pair].left, name(pair, false));
  images.right = picture(pairs_[pair].right, name(pair, true));
  flies::check_pair(images.view(), name(pair, false), name(pair, true));
  return images;
}

flies::Calibration Recording::calibration(const CameraArguments& arguments) const {
  flies::Calibration calibration;
  calibration.camera = camera_;
  calibration.format = "recording";
  calibration.has_height = calibration.has_pitch = has_mount_;
  auto& mount = calibration.camera.mount;
  if (arguments.height_m) mount.height_m = *arguments.height_m;
  if (arguments.pitch_deg) mount.pitch_rad = flies::radians(*arguments.pitch_deg);
  if (arguments.roll_deg) mount.roll_rad = flies::radians(*arguments.roll_deg);
  flies::check_camera(calibration.camera, path_);
  return calibration;
}
