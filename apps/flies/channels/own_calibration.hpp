#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "channels/channels.hpp"
#include "flies/io/calibration.hpp"
#include "flies/record/recorded_message.hpp"

std::string_view topic_of(Channel channel);

/// The camera that `flies live` recorded, from its messages: Foxglove's CameraCalibration and FrameTransform in JSON.
class OwnCalibration {
 public:
  /// Takes what a message says of it, if anything: the first of each topic counts.
  /// @throws InputError naming the file and the topic when a message is not what its schema says
  void read(const flies::RecordedMessage& message, const std::string& path);

  bool has_any() const { return has_left_ || has_right_; }
  std::optional<std::string> missing_topic() const;

  /// As the user asks for it. No topic is missing. @throws InputError as `load_calibration`
  flies::Calibration calibration(const flies::CalibrationRequest& request, const std::string& path) const;

 private:
  flies::StereoCamera camera_;
  bool has_left_ = false, has_right_ = false, has_mount_ = false, has_unreadable_mount_ = false;
};
