#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "live/live_frame.hpp"
#include "shared/line_file.hpp"
#include "track/track_outputs.hpp"

/// As `flies track` has it.
TrackedFrame tracked_frame(const LiveFrame& frame);

/// The line of `--json`, as `flies track` writes it. From any thread.
const std::string& json_line(const LiveFrame& frame);

/// The picture as JPEG, good enough to find the same again in it (quality 95).
std::vector<std::uint8_t> picture_jpeg(const flies::GrayImage& picture);

/// The left picture so. From any thread.
const std::vector<std::uint8_t>& left_jpeg(const LiveFrame& frame);

/// A line of JSON a pair.
class JsonSink final : public LiveSink {
 public:
  explicit JsonSink(const std::string& path) : file_(path) {}
  void take(const LiveFrame& frame) override { file_.write(json_line(frame)); }

 private:
  LineFile file_;
};

/// For people: a line a track, on standard output.
class TableSink final : public LiveSink {
 public:
  void take(const LiveFrame& frame) override;
};
