#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/ego/ego_motion.hpp"
#include "flies/pipeline/detector.hpp"
#include "flies/track/tracks.hpp"

namespace flies {

/// What following adds to the options of a detector.
struct TrackerOptions {
  EgoOptions ego;
  TrackOptions track;

  template <class Self, class Field>
  static void fields(Self& self, Field&& f) {
    f("ego", self.ego);
    f("track", self.track);
  }
};

/// Whether the option of this dotted name is one of following (`TrackerOptions`), not of finding in a pair.
inline bool is_tracker_option(std::string_view path) { return path.starts_with("ego.") || path.starts_with("track."); }

/// What is known after one pair of a sequence.
struct Tracking {
  double time_s = 0.0;
  EgoMotion ego;
  std::vector<Track> tracks;  ///< nearest first
  Detection detection;        ///< of this pair alone
  double ego_ms = 0.0;        ///< beside the first stages of the detection where that runs on several threads
  double track_ms = 0.0;
};

/// Follows things through the pairs of one camera: ego-motion, detection, tracks. The n-th call is a function of the
/// pairs and times so far, camera, options and classifier.
/// Threads: one tracker serves one thread at a time; several may run side by side.
class Tracker {
 public:
  /// @throws InputError when the camera or an option is out of range
  explicit Tracker(const StereoCamera& camera, const DetectorOptions& detector = {}, const TrackerOptions& options = {},
                   std::shared_ptr<const PeopleClassifier> classifier = default_people_classifier());

  /// @param time_s   of the pair, later than that of the one before
  /// @param measured the camera's motion where another sensor knows it; else it is estimated from the images, which
  ///                 takes two in a row without it: after a pair with it the motion of one without is unknown
  /// @throws InputError when the images do not fit the camera or time does not advance
  Tracking process(const RectifiedPair& pair, double time_s, const std::optional<EgoMotion>& measured = std::nullopt);

 private:
  EgoEstimator ego_;
  Detector detector_;
  TrackKeeper keeper_;
};

}  // namespace flies
