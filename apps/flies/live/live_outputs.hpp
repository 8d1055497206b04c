#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
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

/// A line of JSON a pair. A run that has no result leaves a file of an earlier one alone.
class JsonSink final : public LiveSink {
 public:
  explicit JsonSink(std::string path) : path_(std::move(path)) {}
  /// @throws flies::InputError as `LineFile`
  void take(const LiveFrame& frame) override;
  void pass_over(const LiveFrame& frame) override;
  bool has_begun() const { return file_.has_value(); }  ///< not while another thread writes

 private:
  std::string path_;
  std::optional<LineFile> file_;  ///< from the first result on
};

/// For people: a line a track, on standard output.
class TableSink final : public LiveSink {
 public:
  void take(const LiveFrame& frame) override;

 private:
  LineFile out_{"-"};
};
