#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "flies/record/recorded_message.hpp"
#include "flies/record/ros_message.hpp"

/// What the messages of a recording say of how its cameras see: camera_info of ROS, and Foxglove's CameraCalibration in
/// JSON, which has the same fields. Of each topic the first calibrated one counts.
class RecordedCalibrations {
 public:
  /// @throws flies::InputError naming the message when it cannot be read
  void read_ros(const flies::RecordedMessage& message, const std::string& name);
  void read_foxglove(const flies::RecordedMessage& message, const std::string& name);

  /// The topic below or beside that of pictures: camera_info or calibration; nothing where there is none of them.
  std::optional<std::string> topic_of(const std::string& pictures) const;

  /// Of a topic; null where there is none.
  const flies::RosCameraInfo* find(const std::string& topic) const;
  std::vector<std::string> topics() const;

  /// What is told of a topic whose messages change; nothing where they do not.
  std::optional<std::string> change_note(const std::string& topic) const;

 private:
  struct OfTopic {
    flies::RosCameraInfo first;
    std::optional<flies::RosCameraInfo> other;  ///< the first that says something else
  };
  void add(flies::RosCameraInfo info);

  std::map<std::string, OfTopic> by_topic_;
  std::set<std::string> seen_;  ///< topics, those whose messages cannot be read too
};
