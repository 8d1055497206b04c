#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "live/live_frame.hpp"

/// The topics that `flies live` gives to Foxglove, Lichtblick and recordings, in the order of `kChannels`.
enum class Channel : std::size_t {
  left,
  right,
  left_calibration,
  right_calibration,
  annotations,
  scan,
  flies,
  scene,
  pose,
  vehicle_transform,
  camera_transform,
  log,
  record,
};

struct ChannelName {
  std::string_view topic, schema_name;
};
inline constexpr std::array<ChannelName, 13> kChannels = {{
    {"/left", "foxglove.CompressedImage"},
    {"/right", "foxglove.CompressedImage"},
    {"/left/calibration", "foxglove.CameraCalibration"},
    {"/right/calibration", "foxglove.CameraCalibration"},
    {"/left/annotations", "foxglove.ImageAnnotations"},
    {"/scan", "foxglove.LaserScan"},
    {"/flies", "foxglove.PointCloud"},
    {"/tracks", "foxglove.SceneUpdate"},
    {"/pose", "foxglove.PoseInFrame"},
    {"/tf/vehicle", "foxglove.FrameTransform"},
    {"/tf/camera", "foxglove.FrameTransform"},
    {"/log", "foxglove.Log"},
    {"/record", "flies.Record"},
}};

constexpr std::string_view topic_of(Channel channel) { return kChannels[static_cast<std::size_t>(channel)].topic; }

/// What is small and waited for, in the order in which it leaves for a pair.
inline constexpr std::array kResultChannels = {
    Channel::pose,
    Channel::vehicle_transform,
    Channel::camera_transform,
    Channel::scene,
    Channel::scan,
    Channel::annotations,
    Channel::record,
    Channel::left_calibration,
    Channel::right_calibration,
};

/// What is large or takes long to encode.
inline constexpr std::array kPictureChannels = {Channel::flies, Channel::left, Channel::right};

/// Nanoseconds since 1970 when the pair came.
std::uint64_t time_ns_of(const LiveFrame& frame);

/// The message of a channel for a pair, JSON; not for `Channel::log`.
std::string channel_message(Channel channel, const LiveFrame& frame);

/// A sentence for the user as a message of `Channel::log`.
std::string log_message(const std::string& sentence, std::uint64_t time_ns);
