#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "flies/core/gray_view.hpp"
#include "flies/pipeline/tracker.hpp"

namespace flies {

/// What an engine knows at a moment; never changed once it was handed out.
struct Snapshot {
  Tracking tracking;         ///< after the newest pair that is done, at `tracking.time_s`
  std::uint64_t number = 0;  ///< counts the pairs that are done, from 1; 0: none is, and all else is empty
  std::uint64_t submitted = 0, dropped = 0;  ///< pairs so far; dropped ones were overtaken by a newer pair
  double latency_ms = 0.0;                   ///< from `submit` of this pair to its result
  std::string error;  ///< why the newest pair could not be used; the rest is of the pair before it
  std::optional<std::chrono::steady_clock::time_point> arrived;  ///< when the pair of `tracking` was; none yet: nothing
  double newest_time_s = 0.0;  ///< of the newest pair, whether it could be used or not

  /// Time since the pair of `tracking` was submitted, seconds; NaN while there is none, because none came or none could
  /// be used.
  double age_s() const {
    if (!arrived) return std::numeric_limits<double>::quiet_NaN();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - *arrived).count();
  }
};

/// A tracker with a thread of its own, for a living camera: pairs go in whenever they come, and whoever needs the
/// obstacles reads the newest whenever it likes. A pair that has not been started when a newer one comes is dropped and
/// counted, so a burst or a slow machine costs old pairs and never delays new ones.
/// Threads: all members may be called from any threads at once; none waits for work to be done but `wait` and
/// `wait_for_next`.
class Engine {
 public:
  /// @throws InputError when the camera or an option is out of range
  explicit Engine(const StereoCamera& camera, const DetectorOptions& detector = {}, const TrackerOptions& options = {},
                  std::shared_ptr<const PeopleClassifier> classifier = default_people_classifier());
  /// Ends after the pair that is being worked on.
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Copies the pair.
  /// @param time_s of the pair, later than that of the one before
  /// @returns whether the pair before it still waited, and is dropped
  /// @throws InputError when the images are empty or do not fit the camera, or time does not advance
  bool submit(const RectifiedPair& pair, double time_s);

  /// The newest result. Never null.
  std::shared_ptr<const Snapshot> snapshot() const;

  /// Waits for a result newer than number `after`.
  /// @param timeout `milliseconds::max()` waits for ever, in truth for a year; 0 or less not at all
  /// @returns it, or the newest there is when the timeout comes first
  std::shared_ptr<const Snapshot> wait(std::uint64_t after, std::chrono::milliseconds timeout) const;

  /// The same for who must not miss a result, to write them all down: the result after number `after`, or where that is
  /// no longer kept the oldest of the last eight.
  /// @returns it, or the newest there is when the timeout comes first
  std::shared_ptr<const Snapshot> wait_for_next(std::uint64_t after, std::chrono::milliseconds timeout) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace flies
