#pragma once

#include <optional>
#include <string>

#include "flies/core/stereo_camera.hpp"
#include "flies/record/recorded_message.hpp"

/// How the camera that `flies live` recorded is mounted: Foxglove's FrameTransform in JSON, on our own topic. The first
/// that can be read counts.
class RecordedMount {
 public:
  /// Takes what a message says of it, if anything.
  /// @throws InputError naming the file and the topic when the message is not what its schema says
  void read(const flies::RecordedMessage& message, const std::string& path);

  const std::optional<flies::CameraMount>& mount() const { return first_; }

  /// What is told where no message can be read, or a later one says something else.
  std::optional<std::string> note() const;

 private:
  std::optional<flies::CameraMount> first_, other_;
  bool is_damaged_ = false;
};
