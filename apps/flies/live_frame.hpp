#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/io/gray_image.hpp"
#include "flies/pipeline/engine.hpp"

/// A pair of a living source, as the engine got it.
struct LivePair {
  std::uint64_t number = 0;  ///< counts the pairs of the source from 0; gaps in what follows are dropped ones
  flies::GrayPair images;    ///< rectified
  double time_s = 0.0, skew_s = 0.0;
  std::string left_name, right_name;
};

/// A pair and what is known after it: what everyone who writes or shows gets. Shared and never changed.
struct LiveFrame {
  std::shared_ptr<const LivePair> pair;
  std::shared_ptr<const flies::Snapshot> snapshot;
  flies::StereoCamera camera;
  std::uint64_t seed = 0;
  std::string preset;
};

/// Someone who writes or shows what a living source gives. Called from one thread, but `note` from any.
class LiveSink {
 public:
  virtual ~LiveSink() = default;
  virtual void take(const LiveFrame& frame) = 0;
  virtual void note(const std::string& /*sentence*/) {}
};
