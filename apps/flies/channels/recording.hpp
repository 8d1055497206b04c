#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "channels/picture_times.hpp"
#include "channels/recorded_calibrations.hpp"
#include "channels/recorded_mount.hpp"
#include "flies/core/error.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/gray_image.hpp"
#include "flies/io/images.hpp"
#include "flies/record/recorded_message.hpp"
#include "flies/record/ros_message.hpp"
#include "shared/camera_arguments.hpp"

/// The pairs of a recording with its calibration: an MCAP file as `flies live --record` writes it (messages in JSON of
/// Foxglove's CompressedImage, CameraCalibration and FrameTransform), or others write such, or of ROS 2 (CDR), or a bag
/// of ROS 1, with two topics of pictures and their calibration.
class Recording {
 public:
  /// Reads the file once, to know what is where.
  /// @param topics of the left and the right pictures; none: ours, else those whose names say left and right. With a
  ///        split the one whose pictures hold both; none: the only one that there is
  /// @param reading how pictures hold pairs; a mosaic is what grey pictures are that do not say themselves that they
  ///        are one
  /// @throws InputError naming the file, and the topics that there are, when it cannot be read or lacks pictures
  explicit Recording(const std::string& path, const std::vector<std::string>& topics = {},
                     const flies::PairReading& reading = {});

  const std::string& path() const { return path_; }
  std::size_t size() const { return pairs_.size(); }
  double time_s(std::size_t pair) const;  ///< since the first pair
  std::string name(std::size_t pair, bool is_right) const;
  /// Of a pair's left picture among all left ones, those without a partner too; from 0.
  std::size_t left_number(std::size_t pair) const { return pairs_[pair].left_number; }
  std::size_t left_count() const { return pictures_.at(left_).size(); }

  /// From each pair to the next, in intervals of the cameras: more than one where pairs are missing. By the times where
  /// these are even, else by the pictures without a partner.
  std::vector<std::int64_t> steps() const;

  /// @throws InputError naming the file and the pair when a picture is damaged
  flies::GrayPair pair(std::size_t pair) const;

  /// The camera as it was recorded, baseline and mount overruled by what the user says.
  /// @param images a pair of it, whose size may be another than the calibration's
  /// @throws InputError naming the topic that is missing or cannot be read, or the option that is of calibration files
  flies::Calibration calibration(const CameraArguments& arguments, const flies::RectifiedPair& images) const;

  const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct Pair {
    std::uint64_t time_ns = 0;
    std::size_t left_number = 0, right_number = 0;
    flies::MessagePlace left, right;
  };
  /// Of one topic of pictures by their times.
  using Pictures = std::map<std::uint64_t, flies::MessagePlace>;
  /// The same before their times are known, in the order of the file.
  struct Found {
    std::vector<PictureTimes> times;
    std::vector<flies::MessagePlace> places;
  };
  /// Messages of one topic that cannot be read.
  struct Faults {
    flies::InputError first;
    std::size_t count = 0;
  };

  void read_all();
  std::optional<flies::RecordedMessage> next();
  bool is_whole() const;
  [[noreturn]] void complain(const std::string& what) const;
  void read_or_pass_over(const flies::RecordedMessage& message);
  void read(const flies::RecordedMessage& message);
  void add_picture(const flies::RecordedMessage& message, std::uint64_t stamp_ns);
  void place_in_time(const std::string& topic, const Found& found);
  void note_stamps(const std::string& topic);
  void choose_topics(const std::vector<std::string>& topics);
  void choose_joined_topic(const std::vector<std::string>& topics);
  void require_pictures(const std::string& topic) const;
  void throw_fault_of(const std::string& topic) const;
  void note_losses(const std::string& topic);
  void pair_up();
  void take_joined_pairs();
  bool is_joined() const { return reading_.split != flies::Split::none; }
  std::string picture_topics() const;
  std::string unread_topics() const;
  std::string calibration_topic(const std::string& pictures) const;
  const flies::RosCameraInfo& camera_info(const std::string& topic) const;
  void read_ros_picture(const flies::RecordedMessage& message, const std::string& name);
  cv::Mat picture(const flies::MessagePlace& place, const std::string& name) const;
  bool is_our_own() const;

  std::string path_;
  flies::PairReading reading_;
  std::unique_ptr<flies::RecordingReader> reader_;
  std::map<std::string, Found> found_;
  std::map<std::string, Pictures> pictures_;
  std::map<std::string, std::size_t> replaced_;       ///< pictures of a topic that had the time of a later one
  std::map<std::string, std::size_t> unread_stamps_;  ///< pictures of a topic whose stamps are in an unknown form
  std::map<std::string, Faults> faults_;              ///< of the topics that have some
  std::optional<Faults> damaged_;                     ///< parts of the file that were passed over
  std::map<std::string, std::size_t> unread_;   ///< messages with pictures of kinds that are not read, by their topics
  std::map<std::string, std::string> mosaics_;  ///< topics of mosaics of colours, and how these say that they are some
  RecordedCalibrations calibrations_;
  std::string left_, right_;  ///< the topics; with a split the same
  std::vector<Pair> pairs_;
  RecordedMount mount_;
  bool has_own_pictures_ = false;  ///< on the topic of our left ones
  std::vector<std::string> notes_;
};
