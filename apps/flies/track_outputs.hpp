#pragma once

#include <cstdint>
#include <string>

#include "flies/core/stereo_camera.hpp"
#include "flies/pipeline/tracker.hpp"

/// One pair of a sequence and what is known after it.
struct TrackedFrame {
  int frame = 0;
  std::string left, right;
  std::uint64_t seed = 0;
  std::string preset;
  flies::StereoCamera camera;
  flies::Tracking tracking;
};

/// The line of `flies detect` with `time_s`, `ego` and `tracks` added; docs/formats.md holds the schema.
std::string track_json_line(const TrackedFrame& frame);

/// KITTI's tracking format, a line a track.
std::string kitti_tracking_lines(const TrackedFrame& frame);

/// For people: a line a track.
std::string track_table(const TrackedFrame& frame);
