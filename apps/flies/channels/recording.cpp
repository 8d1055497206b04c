#include "channels/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "channels/channels.hpp"
#include "flies/core/base64.hpp"
#include "flies/core/error.hpp"
#include "flies/io/calibration_formats.hpp"
#include "flies/record/ros_calibration.hpp"

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

/// Pictures of two cameras that are farther apart in time make no pair.
constexpr std::uint64_t kMaxSkew_ns = 20'000'000;

/// The topic that says how a camera of ROS sees: beside that of its pictures.
std::string camera_info_topic(std::string pictures) {
  constexpr std::string_view kCompressed = "/compressed";
  if (pictures.ends_with(kCompressed)) pictures.resize(pictures.size() - kCompressed.size());
  return pictures.substr(0, pictures.rfind('/') + 1) + "camera_info";
}

/// Whether ROS calls these pictures rectified: image_rect, image_rect_color.
bool is_called_rectified(const std::string& pictures) { return pictures.find("image_rect") != std::string::npos; }

/// The name with left for right.
std::string of_the_left(std::string topic) {
  for (auto at = topic.find("right"); at != std::string::npos; at = topic.find("right", at + 4))
    topic.replace(at, 5, "left");
  return topic;
}

/// When a picture was taken; of a camera that does not say, when it was recorded.
std::uint64_t picture_time_ns(const flies::RecordedMessage& message, const std::string& name) {
  const std::uint64_t stamp_ns = flies::ros_stamp_ns(message, name);
  return stamp_ns == 0 ? message.time_ns : stamp_ns;
}

/// @param is_our_own its pictures are rectified, of the calibration's size
/// @throws InputError naming an option that says how a calibration file is to be read
void refuse_options_of_files(const CameraArguments& arguments, bool is_our_own, const std::string& path) {
  const std::array<std::pair<const char*, bool>, 5> options = {{{"--right-calib", !arguments.right_calib.empty()},
                                                                {"--calib-size", !arguments.calibrated_size_px.empty()},
                                                                {"--raw", is_our_own && arguments.is_raw},
                                                                {"--resized", is_our_own && arguments.is_resized},
                                                                {"--cameras", !arguments.cameras.empty()}}};
  for (const auto& [option, is_given] : options)
    if (is_given)
      throw flies::InputError(path, option,
                              "is for a calibration file (--calib); without one the recording's own counts");
}

/// The entry whose time is nearest; of two the later one. There is one.
template <class ByTime>
typename ByTime::const_iterator nearest(const ByTime& entries, std::uint64_t time_ns) {
  auto found = entries.lower_bound(time_ns);
  if (found == entries.end() ||
      (found != entries.begin() && time_ns - std::prev(found)->first < found->first - time_ns))
    --found;
  return found;
}

}  // namespace

void Recording::read_calibration(const flies::RecordedMessage& message) {
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

Recording::Recording(const std::string& path, const std::optional<std::array<std::string, 2>>& topics)
    : path_(path), reader_(flies::open_recording(path)) {
  read_all();
  choose_topics(topics);
  pair_up();
  for (const auto& topic : {left_, right_}) note_losses(topic);
  if (!early_end_.empty()) notes_.push_back(fmt::format("{} after {} pairs", early_end_, pairs_.size()));
}

void Recording::read_all() {
  try {
    while (const auto message = reader_->next()) read_or_pass_over(*message);
    if (!reader_->is_whole()) early_end_ = path_ + ": is cut off or damaged";
  } catch (const flies::InputError& fault) {
    if (pictures_.empty()) throw;
    early_end_ = std::string(fault.what()) + "; reading ended";
  }
  if (pictures_.empty() && !faults_.empty()) throw faults_.begin()->second.first;
  if (pictures_.empty() && !early_end_.empty())
    throw flies::InputError(path_, "", "is cut off or damaged, and what is whole of it holds no pictures");
}

void Recording::read_or_pass_over(const flies::RecordedMessage& message) {
  try {
    read(message);
  } catch (const flies::InputError& fault) {
    ++faults_.try_emplace(message.topic, Faults{fault}).first->second.count;
  }
}

void Recording::throw_fault_of(const std::string& topic) const {
  if (const auto found = faults_.find(topic); found != faults_.end()) throw found->second.first;
}

void Recording::read(const flies::RecordedMessage& message) {
  const auto name = path_ + " " + message.topic;
  switch (flies::ros_type(message)) {
    case flies::RosType::image:
    case flies::RosType::compressed_image:
      add_picture(message, picture_time_ns(message, name));
      return;
    case flies::RosType::camera_info:
      if (!camera_infos_.contains(message.topic)) camera_infos_[message.topic] = flies::ros_camera_info(message, name);
      return;
    case flies::RosType::other:
      break;
  }
  if (message.encoding != "json") return;
  const bool is_left = message.topic == topic_of(Channel::left);
  if (is_left || message.topic == topic_of(Channel::right)) add_picture(message, message.time_ns);
  has_own_pictures_ |= is_left;
  read_calibration(message);
}

void Recording::add_picture(const flies::RecordedMessage& message, std::uint64_t time_ns) {
  const bool is_new = pictures_[message.topic].insert_or_assign(time_ns, message.place).second;
  if (!is_new) ++replaced_[message.topic];
}

/// The topics that hold pictures, for errors.
std::string Recording::picture_topics() const {
  std::vector<std::string> names;
  for (const auto& [topic, pictures] : pictures_) names.push_back(fmt::format("{} ({})", topic, pictures.size()));
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

void Recording::choose_topics(const std::optional<std::array<std::string, 2>>& topics) {
  if (topics) {
    for (const auto& topic : *topics) {
      if (pictures_.contains(topic)) continue;
      throw_fault_of(topic);
      throw flies::InputError(path_, "--topics",
                              fmt::format("no pictures in '{}'; topics with pictures: {}", topic, picture_topics()));
    }
    left_ = (*topics)[0];
    right_ = (*topics)[1];
    return;
  }
  std::vector<std::string> found;  // right topics whose left ones are there
  for (const auto& [topic, pictures] : pictures_)
    if (const auto left = of_the_left(topic); left != topic && pictures_.contains(left)) found.push_back(topic);
  // Of several the rectified ones, and of those the ones that are not compressed a second time.
  const auto rank = [](const std::string& topic) {
    return std::pair(!is_called_rectified(topic), topic.ends_with("/compressed"));
  };
  std::ranges::stable_sort(found, {}, rank);
  if (found.empty() || (found.size() > 1 && rank(found[0]) == rank(found[1])))
    throw flies::InputError(
        path_, "",
        fmt::format("cannot tell the left pictures from the right ones; name two topics by --topics LEFT,RIGHT; "
                    "topics with pictures: {}",
                    picture_topics()));
  right_ = found.front();
  left_ = of_the_left(right_);
}

/// Two pictures are a pair when each is the nearest to the other, as images of two folders are.
void Recording::pair_up() {
  const Pictures &left = pictures_[left_], &right = pictures_[right_];
  for (const auto& [time_ns, place] : left) {
    const auto& [right_ns, right_place] = *nearest(right, time_ns);
    const std::uint64_t skew_ns = std::max(time_ns, right_ns) - std::min(time_ns, right_ns);
    if (skew_ns <= kMaxSkew_ns && nearest(left, right_ns)->first == time_ns)
      pairs_.push_back({time_ns, place, right_place});
  }
  if (pairs_.empty())
    throw flies::InputError(path_, "",
                            fmt::format("holds no pairs: no pictures of {} and {} are within {} ms of each other",
                                        left_, right_, kMaxSkew_ns / 1'000'000));
  const std::size_t alone = pictures_[left_].size() - pairs_.size();
  if (alone > 0) notes_.push_back(fmt::format("{}: {} pictures of {} have no partner", path_, alone, left_));
}

/// Tells which pictures of a topic were left out, and why.
void Recording::note_losses(const std::string& topic) {
  if (const auto found = replaced_.find(topic); found != replaced_.end())
    notes_.push_back(
        fmt::format("{}: {} pictures of {} are left out: later ones have their times", path_, found->second, topic));
  if (const auto found = faults_.find(topic); found != faults_.end())
    notes_.push_back(fmt::format("{}: {} messages of {} are left out: they cannot be read; the first: {}", path_,
                                 found->second.count, topic, found->second.first.what()));
}

double Recording::time_s(std::size_t pair) const {
  return 1e-9 * static_cast<double>(pairs_[pair].time_ns - pairs_.front().time_ns);
}

std::string Recording::name(std::size_t pair, bool is_right) const {
  return fmt::format("{} {} {}", path_, is_right ? right_ : left_, pair);
}

flies::GrayImage Recording::picture(const flies::MessagePlace& place, const std::string& name) const {
  const auto message = reader_->at(place);
  if (flies::ros_type(message) != flies::RosType::other) return flies::ros_picture(message, name);
  const Json json = Json::parse(message.data, nullptr, false);
  const auto bytes = json.is_object() && json.contains("data") && json["data"].is_string()
                         ? flies::from_base64(json["data"].get<std::string>())
                         : std::nullopt;
  if (!bytes) throw flies::InputError(name, "", "is no picture");
  return flies::gray_picture(*bytes, name);
}

flies::GrayPair Recording::pair(std::size_t pair) const {
  flies::GrayPair images;
  images.left = picture(pairs_[pair].left, name(pair, false));
  images.right = picture(pairs_[pair].right, name(pair, true));
  flies::check_pair(images.view(), name(pair, false), name(pair, true));
  return images;
}

const flies::RosCameraInfo& Recording::camera_info(const std::string& topic) const {
  const auto found = camera_infos_.find(topic);
  if (found != camera_infos_.end()) return found->second;
  throw_fault_of(topic);
  std::vector<std::string> names;
  for (const auto& [name, info] : camera_infos_) names.push_back(name);
  throw flies::InputError(path_, topic,
                          fmt::format("is missing, so the calibration is not known; give it by --calib; topics with a "
                                      "camera_info: {}",
                                      names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

/// Whether `flies live` wrote it.
bool Recording::is_our_own() const {
  return left_ == topic_of(Channel::left) && (has_left_ || has_right_ || has_own_pictures_);
}

flies::Calibration Recording::own_calibration(const CameraArguments& arguments) const {
  if (!has_left_ || !has_right_) {
    const std::string topic(topic_of(has_left_ ? Channel::right_calibration : Channel::left_calibration));
    throw_fault_of(topic);
    throw flies::InputError(path_, topic, "is missing");
  }
  flies::check_camera(camera_, path_);
  flies::Calibration calibration;
  calibration.camera = camera_;
  calibration.format = "recording";
  calibration.has_height = calibration.has_pitch = has_mount_;
  if (!has_mount_)
    calibration.notes.push_back(
        {"does not say where the camera sits; the default mount is assumed", flies::CalibrationNoteKind::mount});
  if (arguments.baseline_m) flies::detail::override_baseline(*arguments.baseline_m, path_, calibration);
  auto& mount = calibration.camera.mount;
  if (arguments.height_m) mount.height_m = *arguments.height_m;
  if (arguments.pitch_deg) mount.pitch_rad = flies::radians(*arguments.pitch_deg);
  if (arguments.roll_deg) mount.roll_rad = flies::radians(*arguments.roll_deg);
  calibration.has_height |= arguments.height_m.has_value();
  calibration.has_pitch |= arguments.pitch_deg.has_value();
  flies::check_camera(calibration.camera, path_);
  return calibration;
}

flies::Calibration Recording::calibration(const CameraArguments& arguments, const flies::RectifiedPair& images) const {
  refuse_options_of_files(arguments, is_our_own(), path_);
  if (is_our_own()) return own_calibration(arguments);
  const auto& left = camera_info(camera_info_topic(left_));
  const auto& right = camera_info(camera_info_topic(right_));
  flies::CalibrationRequest request = calibration_request(arguments, left_, right_, images);
  request.images_are_raw |=
      !is_called_rectified(left_) && !(flies::is_rectified_by_nature(left) && flies::is_rectified_by_nature(right));
  flies::Calibration calibration = flies::ros_calibration(left, right, request, path_);
  calibration.left_name = left_;
  calibration.right_name = right_;
  return calibration;
}
