#pragma once

#include <string>

#include "live/live_frame.hpp"
#include "shared/line_file.hpp"
#include "track/track_outputs.hpp"

/// As `flies track` has it.
TrackedFrame tracked_frame(const LiveFrame& frame);

/// A line of JSON a pair.
class JsonSink final : public LiveSink {
 public:
  explicit JsonSink(const std::string& path) : file_(path) {}
  void take(const LiveFrame& frame) override { file_.write(track_json_line(tracked_frame(frame))); }

 private:
  LineFile file_;
};

/// For people: a line a track, on standard output.
class TableSink final : public LiveSink {
 public:
  void take(const LiveFrame& frame) override;
};
