#include "channels/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <utility>

#include "channels/channels.hpp"
#include "channels/recorded_topics.hpp"
#include "flies/core/base64.hpp"
#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/io/gray_levels.hpp"
#include "flies/record/ros_calibration.hpp"
#include "flies/video/pair_stream.hpp"

namespace {

using Json = nlohmann::json;

/// Pictures of two cameras that are farther apart in time make no pair.
constexpr std::uint64_t kMaxSkew_ns = 20'000'000;

/// Whether messages of this kind hold pictures, be they read here or not: of ROS, Foxglove, and what packs films.
bool is_of_pictures(const std::string& schema_name) {
  constexpr std::array<std::string_view, 6> kKinds = {"Image",           "CompressedImage", "RawImage",
                                                      "CompressedVideo", "Packet",          "FFMPEGPacket"};
  return std::ranges::find(kKinds, schema_name.substr(schema_name.find_last_of("/.") + 1)) != kKinds.end();
}

/// Whether a message in JSON is a picture as we record them; some name no schema.
bool is_picture_in_json(const flies::RecordedMessage& message) {
  if (message.encoding != "json") return false;
  if (!message.schema_name.empty()) return message.schema_name == "foxglove.CompressedImage";
  return message.topic == topic_of(Channel::left) || message.topic == topic_of(Channel::right);
}

/// Whether a message in JSON says how a camera sees; some name no schema.
bool is_calibration_in_json(const flies::RecordedMessage& message) {
  if (!message.schema_name.empty()) return message.schema_name == "foxglove.CameraCalibration";
  return message.topic == topic_of(Channel::left_calibration) || message.topic == topic_of(Channel::right_calibration);
}

/// @param is_our_own its pictures are rectified, of the calibration's size
/// @throws InputError naming an option that says how a calibration file is to be read
void refuse_options_of_files(const CameraArguments& arguments, bool is_our_own, const std::string& path) {
  const std::array<std::pair<const char*, bool>, 5> options = {
      {{"--right-calib", !arguments.right_calib.empty()},
       {"--calib-size", is_our_own && !arguments.calibrated_size_px.empty()},
       {"--raw", is_our_own && arguments.is_raw},
       {"--resized", is_our_own && arguments.is_resized},
       {"--cameras", !arguments.cameras.empty()}}};
  for (const auto& [option, is_given] : options)
    if (is_given)
      throw flies::InputError(path, option,
                              "is for a calibration file (--calib); without one the recording's own counts");
}

}  // namespace

Recording::Recording(const std::string& path, const std::vector<std::string>& topics, const flies::PairReading& reading)
    : path_(path), reading_(reading), reader_(flies::open_recording(path)) {
  read_all();
  if (is_joined()) {
    choose_joined_topic(topics);
    take_joined_pairs();
  } else {
    choose_topics(topics);
    pair_up();
    note_losses(left_);
  }
  note_losses(right_);
  if (damaged_)
    notes_.push_back(
        damaged_->count == 1
            ? fmt::format("{}; that part of the file is left out, with all that is in it", damaged_->first.what())
            : fmt::format("{}; {} such parts of the file are left out, with all that is in them",
                          damaged_->first.what(), damaged_->count));
  if (!reader_->is_whole())
    notes_.push_back(fmt::format("{}: is cut off or damaged after {} pairs", path_, pairs_.size()));
}

void Recording::read_all() {
  while (const auto message = next()) read_or_pass_over(*message);
  for (const auto& [topic, found] : found_) place_in_time(topic, found);
  if (!pictures_.empty()) return;
  if (damaged_) throw flies::InputError(damaged_->first);
  if (!faults_.empty()) throw flies::InputError(faults_.begin()->second.first);
  complain(unread_.empty() ? "holds no pictures" : "holds no pictures that can be read" + unread_topics());
}

/// The next message behind what is damaged.
std::optional<flies::RecordedMessage> Recording::next() {
  while (true) {
    try {
      return reader_->next();
    } catch (const flies::InputError& fault) {
      if (!damaged_) damaged_.emplace(Faults{fault});
      ++damaged_->count;
    }
  }
}

bool Recording::is_whole() const { return reader_->is_whole() && !damaged_; }

/// @throws InputError saying first that the file is not whole, if so
void Recording::complain(const std::string& what) const {
  throw flies::InputError(path_, "", is_whole() ? what : "is cut off or damaged, and the intact part of it " + what);
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
      return read_ros_picture(message, name);
    case flies::RosType::camera_info:
      return calibrations_.read_ros(message, name);
    case flies::RosType::other:
      break;
  }
  if (is_picture_in_json(message)) {
    const auto stamp_ns = json_stamp_ns(message.data);
    if (!stamp_ns) ++unread_stamps_[message.topic];
    add_picture(message, stamp_ns.value_or(0));
    has_own_pictures_ |= message.topic == topic_of(Channel::left);
  } else if (is_of_pictures(message.schema_name)) {
    ++unread_[fmt::format("{} ({} in {})", message.topic, message.schema_name, message.encoding)];
  } else if (message.encoding == "json") {
    if (is_calibration_in_json(message)) calibrations_.read_foxglove(message, name);
    mount_.read(message, path_);
  } else if (message.schema_name.empty()) {
    ++unread_[fmt::format("{} (without a schema, in {})", message.topic, message.encoding)];
  }
}

void Recording::read_ros_picture(const flies::RecordedMessage& message, const std::string& name) {
  const std::string format = flies::ros_picture_format(message, name);
  if (format.find("compressedDepth") != format.npos) {
    ++unread_[fmt::format("{} (compressedDepth)", message.topic)];
    return;
  }
  if (flies::ros_bayer_pattern(format)) mosaics_.try_emplace(message.topic, format);
  add_picture(message, flies::ros_stamp_ns(message, name));
}

void Recording::add_picture(const flies::RecordedMessage& message, std::uint64_t stamp_ns) {
  auto& [times, places] = found_[message.topic];
  times.push_back({stamp_ns, message.time_ns});
  places.push_back(message.place);
}

void Recording::place_in_time(const std::string& topic, const Found& found) {
  const auto times_ns = times_on_one_clock(found.times);
  Pictures& pictures = pictures_[topic];
  for (std::size_t i = 0; i < times_ns.size(); ++i)
    if (!pictures.insert_or_assign(times_ns[i], found.places[i]).second) ++replaced_[topic];
}

/// The topics that hold pictures, for errors.
std::string Recording::picture_topics() const {
  std::vector<std::string> names;
  for (const auto& [topic, pictures] : pictures_) names.push_back(fmt::format("{} ({})", topic, pictures.size()));
  return fmt::format("topics with pictures: {}{}", fmt::join(names, ", "), unread_topics());
}

/// And those that hold some of a kind that is not read; empty when none do.
std::string Recording::unread_topics() const {
  if (unread_.empty()) return {};
  std::vector<std::string> names;
  for (const auto& [topic, count] : unread_) names.push_back(fmt::format("{}: {}", topic, count));
  return fmt::format(
      "; it holds some of types that flies does not read: {}; flies reads Image and CompressedImage of ROS, and "
      "Foxglove's CompressedImage in JSON",
      fmt::join(names, ", "));
}

void Recording::require_pictures(const std::string& topic) const {
  if (pictures_.contains(topic)) return;
  throw_fault_of(topic);
  complain(fmt::format("holds no pictures in '{}' (--topics); {}", topic, picture_topics()));
}

/// The topic whose pictures hold both images.
void Recording::choose_joined_topic(const std::vector<std::string>& topics) {
  if (topics.size() > 1)
    throw flies::InputError("command line", "--topics",
                            "found two topics, expected one: with --split its pictures hold both images");
  if (topics.empty() && pictures_.size() > 1)
    throw flies::InputError(
        path_, "",
        "holds pictures in several topics; name the one that holds both images with --topics TOPIC; " +
            picture_topics());
  left_ = right_ = topics.empty() ? pictures_.begin()->first : topics.front();
  require_pictures(left_);
}

void Recording::choose_topics(const std::vector<std::string>& topics) {
  if (topics.size() == 1)
    throw flies::InputError("command line", "--topics",
                            "found one topic, expected LEFT,RIGHT, or --split if its pictures hold both images");
  if (!topics.empty()) {
    for (const auto& topic : topics) require_pictures(topic);
    left_ = topics[0];
    right_ = topics[1];
    return;
  }
  std::vector<std::string> names;
  for (const auto& [topic, pictures] : pictures_) names.push_back(topic);
  if (const auto found = stereo_topics(names)) {
    left_ = found->left;
    right_ = found->right;
    if (found->is_by_number)
      notes_.push_back(
          fmt::format("{}: no topic name says left or right: {} is taken as the left one, {} as the right one; choose "
                      "others with --topics LEFT,RIGHT",
                      path_, left_, right_));
    return;
  }
  if (names.size() < 2)
    complain("holds no pairs, which need pictures of two topics, or --split if each picture holds both images; " +
             picture_topics());
  throw flies::InputError(
      path_, "",
      "cannot tell the left pictures from the right ones; name two topics with --topics LEFT,RIGHT; " +
          picture_topics());
}

void Recording::take_joined_pairs() {
  for (const auto& [time_ns, place] : pictures_[left_])
    pairs_.push_back({time_ns, pairs_.size(), pairs_.size(), place, place});
}

/// Two pictures are a pair when each is the nearest to the other, as images of two folders are.
void Recording::pair_up() {
  const Pictures &left = pictures_[left_], &right = pictures_[right_];
  std::map<std::uint64_t, std::size_t> right_numbers;
  for (const auto& [time_ns, place] : right) right_numbers.emplace(time_ns, right_numbers.size());
  std::vector<double> distances_s, skews_s;
  std::size_t number = 0;
  for (const auto& [time_ns, place] : left) {
    const auto& [right_ns, right_place] = *nearest(right, time_ns);
    const std::uint64_t skew_ns = std::max(time_ns, right_ns) - std::min(time_ns, right_ns);
    distances_s.push_back(1e-9 * static_cast<double>(skew_ns));
    if (skew_ns <= kMaxSkew_ns && nearest(left, right_ns)->first == time_ns) {
      pairs_.push_back({time_ns, number, right_numbers.at(right_ns), place, right_place});
      skews_s.push_back(distances_s.back());
    }
    ++number;
  }
  if (pairs_.empty())
    complain(
        fmt::format("holds no pairs: no pictures of {} and {} are within {} ms of each other; they are {:.4g} ms "
                    "apart (median)",
                    left_, right_, kMaxSkew_ns / 1'000'000, 1e3 * flies::upper_median(distances_s)));
  if (const auto note = flies::skew_note(skews_s)) notes_.push_back(fmt::format("{}: {}", path_, *note));
}

/// Tells which pictures of a topic were left out, and why.
void Recording::note_losses(const std::string& topic) {
  note_stamps(topic);
  if (const std::size_t alone = pictures_[topic].size() - pairs_.size(); alone > 0)
    notes_.push_back(fmt::format("{}: {} pictures of {} have no partner", path_, alone, topic));
  if (const auto found = replaced_.find(topic); found != replaced_.end())
    notes_.push_back(
        fmt::format("{}: {} pictures of {} are left out: later ones have the same times", path_, found->second, topic));
  if (const auto found = mosaics_.find(topic); found != mosaics_.end())
    notes_.push_back(fmt::format("{}: pictures of {} are Bayer mosaics ({}) and are converted to grey", path_, topic,
                                 found->second));
  if (const auto found = faults_.find(topic); found != faults_.end())
    notes_.push_back(fmt::format("{}: {} messages of {} are left out, because they cannot be read; the first error: {}",
                                 path_, found->second.count, topic, found->second.first.what()));
}

/// Tells where stamps are not those of the pictures.
void Recording::note_stamps(const std::string& topic) {
  if (const auto found = unread_stamps_.find(topic); found != unread_stamps_.end()) {
    notes_.push_back(fmt::format(
        "{}: the stamps of {} pictures of {} cannot be read (expected \"timestamp\" with sec and nsec, or in "
        "RFC 3339): the times at which these were recorded are used instead",
        path_, found->second, topic));
    return;
  }
  const auto& times = found_[topic].times;
  const auto missing = static_cast<std::size_t>(std::ranges::count(times, 0U, &PictureTimes::stamp_ns));
  if (missing > 0 && missing < times.size())
    notes_.push_back(
        fmt::format("{}: {} pictures of {} have no stamp (0): they are placed among the others by the "
                    "times at which they were recorded",
                    path_, missing, topic));
}

std::vector<std::int64_t> Recording::steps() const {
  std::vector<std::uint64_t> distances_ns;
  for (std::size_t i = 1; i < pairs_.size(); ++i) distances_ns.push_back(pairs_[i].time_ns - pairs_[i - 1].time_ns);
  if (auto by_times = multiples_of_usual(distances_ns)) return *std::move(by_times);
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < pairs_.size(); ++i)
    steps.push_back(static_cast<std::int64_t>(std::max(pairs_[i].left_number - pairs_[i - 1].left_number,
                                                       pairs_[i].right_number - pairs_[i - 1].right_number)));
  return steps;
}

double Recording::time_s(std::size_t pair) const {
  return 1e-9 * static_cast<double>(pairs_[pair].time_ns - pairs_.front().time_ns);
}

std::string Recording::name(std::size_t pair, bool is_right) const {
  return fmt::format("{} {} {}", path_, is_right ? right_ : left_, pair);
}

cv::Mat Recording::picture(const flies::MessagePlace& place, const std::string& name) const {
  const auto message = reader_->at(place);
  if (flies::ros_type(message) != flies::RosType::other) return flies::ros_picture(message, name, reading_.bayer);
  const Json json = Json::parse(message.data, nullptr, false);
  const auto bytes = json.is_object() && json.contains("data") && json["data"].is_string()
                         ? flies::from_base64(json["data"].get<std::string>())
                         : std::nullopt;
  if (!bytes) throw flies::InputError(name, "", "is no picture");
  return flies::picture_of_file(*bytes, name, reading_.bayer);
}

flies::GrayPair Recording::pair(std::size_t pair) const {
  const cv::Mat left = picture(pairs_[pair].left, name(pair, false));  // whose faults are told first
  if (is_joined()) return flies::pair_of_halves(left, reading_.split, name(pair, false));
  const cv::Mat right = picture(pairs_[pair].right, name(pair, true));
  flies::GrayPair images = flies::pair_of_levels(left, right);
  flies::check_pair(images.view(), name(pair, false), name(pair, true));
  return images;
}

const flies::RosCameraInfo& Recording::camera_info(const std::string& topic) const {
  if (const auto* found = calibrations_.find(topic)) return *found;
  throw_fault_of(topic);
  const auto names = calibrations_.topics();
  throw flies::InputError(
      path_, topic,
      fmt::format("is missing{}, so the calibration is not known; give it with --calib; topics with a calibration: {}",
                  is_whole() ? "" : " from the intact part of the file, which is cut off or damaged",
                  names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

/// The topic that says how the camera of these pictures sees; where there is none, the usual one.
std::string Recording::calibration_topic(const std::string& pictures) const {
  if (auto found = calibrations_.topic_of(pictures)) return *std::move(found);
  return has_own_pictures_ ? pictures + "/calibration" : camera_info_topic(pictures);
}

/// Whether `flies live` may have written it: on our topics, and nothing is left to rectify. Others use these names too.
bool Recording::is_our_own() const {
  if (left_ != topic_of(Channel::left) || right_ != topic_of(Channel::right)) return false;
  return std::ranges::all_of(std::array{left_, right_}, [&](const std::string& pictures) {
    const auto* info = calibrations_.find(calibration_topic(pictures));
    return info == nullptr || (info->distortion.empty() && flies::is_rectified_by_nature(*info));
  });
}

flies::Calibration Recording::calibration(const CameraArguments& arguments, const flies::RectifiedPair& images) const {
  refuse_options_of_files(arguments, is_our_own(), path_);
  const std::array topics = {calibration_topic(left_), calibration_topic(right_)};
  const auto& left = camera_info(topics[0]);
  const auto& right = camera_info(topics[1]);
  flies::CalibrationRequest request = calibration_request(arguments, left_, right_, images);
  request.images_are_raw |=
      !is_called_rectified(left_) && !(flies::is_rectified_by_nature(left) && flies::is_rectified_by_nature(right));
  flies::Calibration calibration =
      flies::ros_calibration(left, right, request, path_, is_our_own() ? mount_.mount() : std::nullopt);
  calibration.left_name = left_;
  calibration.right_name = right_;
  for (const auto& topic : topics)
    if (const auto note = calibrations_.change_note(topic)) calibration.notes.push_back({*note});
  if (const auto note = mount_.note(); note && is_our_own())
    calibration.notes.push_back({*note, flies::CalibrationNoteKind::mount});
  return calibration;
}
