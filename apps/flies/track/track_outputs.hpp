#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "flies/core/stereo_camera.hpp"
#include "flies/io/writers.hpp"
#include "flies/pipeline/tracker.hpp"

/// What only a living source has.
struct LiveRecord {
  double latency_ms = 0.0;    ///< from the arrival of the pair to its result
  double skew_ms = 0.0;       ///< of the right picture after the left one
  std::uint64_t dropped = 0;  ///< pairs so far that were overtaken
  std::uint64_t skipped = 0;  ///< pictures so far that were overtaken before they were read, or came in a pause
};

/// One pair of a sequence and what is known after it.
struct TrackedFrame {
  int frame = 0;
  std::string left, right;
  std::uint64_t seed = 0;
  std::string preset;
  flies::StereoCamera camera;
  flies::Tracking tracking;
  std::optional<LiveRecord> live = {};
  std::shared_ptr<const flies::RunRecord> run = {};
  std::optional<flies::DiagnosisRecord> diagnosis = {};  ///< of the whole run
};

/// The line of `flies detect` with `time_s`, `ego`, `tracks` and, of a living source, `live` added; docs/formats.md
/// holds the schema.
/// @param error why the pair could not be used: the line then says so and holds nothing else but what it is of
std::string track_json_line(const TrackedFrame& frame, const std::string& error = {});

/// KITTI's tracking format, a line a track.
std::string kitti_tracking_lines(const TrackedFrame& frame);

/// For people: a line a track.
std::string track_table(const TrackedFrame& frame);
