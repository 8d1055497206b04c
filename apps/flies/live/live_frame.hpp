#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/io/gray_image.hpp"
#include "flies/io/writers.hpp"
#include "flies/pipeline/engine.hpp"

/// A pair of a living source, as the engine got it.
struct LivePair {
  std::uint64_t number = 0;  ///< counts the pairs of the source from 0; gaps in what follows are dropped ones
  flies::GrayPair images;    ///< rectified
  double time_s = 0.0, skew_s = 0.0;
  std::uint64_t skipped = 0;  ///< pictures of the source so far that newer ones overtook unread, or that came during a
                              ///< pause; they have no number
  std::string left_name, right_name;
};

/// Where the vehicle is on the ground, by adding up its motion: x forward and y left at the first pair.
struct GroundPose {
  double x_m = 0.0, y_m = 0.0, yaw_rad = 0.0;
  int segment =
      0;  ///< counts up when the motion was lost: poses of different segments have nothing to do with each other
};

/// The pose after one more motion. An unknown motion begins a new segment at the origin.
GroundPose moved(const GroundPose& pose, const flies::EgoMotion& ego);

/// What several sinks write of one pair: made for the first that asks (`json_line`, `left_jpeg`), kept for the others.
struct FrameEncodings {
  std::once_flag line_once, jpeg_once;
  std::string line;
  std::vector<std::uint8_t> jpeg;
};

/// A pair and what is known after it: what everyone who writes or shows gets. Shared and never changed.
struct LiveFrame {
  std::shared_ptr<const LivePair> pair;
  std::shared_ptr<const flies::Snapshot> snapshot;
  flies::StereoCamera camera;
  GroundPose pose;
  std::uint64_t dropped = 0;  ///< pairs so far, by all engines of the run
  std::shared_ptr<const flies::DetectorOptions> options =
      {};  ///< these and the next are what this pair was worked on with
  std::shared_ptr<const flies::TrackerOptions> following = {};
  std::string preset = {};
  std::shared_ptr<const flies::RunRecord> run = {};
  std::shared_ptr<const flies::DiagnosisRecord> diagnosis = {};
  std::uint64_t began_ns = 0;  ///< nanoseconds since 1970 at time 0 of the pairs
  std::shared_ptr<FrameEncodings> encodings = std::make_shared<FrameEncodings>();

  /// Bytes of its pictures, most of what it holds.
  std::size_t picture_bytes() const { return pair->images.left.pixels.size() + pair->images.right.pixels.size(); }
};

/// Someone who writes or shows what a living source gives. Called from one thread, but `note` from any.
class LiveSink {
 public:
  virtual ~LiveSink() = default;
  virtual void take(const LiveFrame& frame) = 0;
  /// A pair that is not worked on: `snapshot->error` says why, and of the rest only its time is known.
  virtual void pass_over(const LiveFrame& /*frame*/) {}
  virtual void note(const std::string& /*sentence*/) {}
};
