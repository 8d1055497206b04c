#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/core/planar_motion.hpp"
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
/// Threads: one tracker serves one thread at a time; several may run side by side. One that was moved from may be
/// assigned to and destroyed; a call of `process` throws std::logic_error.
class Tracker {
 public:
  /// @throws InputError when the camera or an option is out of range
  explicit Tracker(const StereoCamera& camera, const DetectorOptions& detector = {}, const TrackerOptions& options = {},
                   std::shared_ptr<const PeopleClassifier> classifier = default_people_classifier());

  /// A pair that is refused changes nothing, but for the way of the camera where it is known: tracks and what the
  /// detector remembers move on by it. Where the motion given with it, or estimated before the refusal, is unknown, all
  /// tracks end. With a motion, its time counts as used.
  /// @param time_s   of the pair, a nanosecond or more after the one before
  /// @param measured the camera's motion where another sensor knows it; else it is estimated from the images, which
  ///                 takes two in a row without it: after a pair with it the motion of one without is unknown. Its
  ///                 `dt_s` must be the time since the pair before to a tenth and 20 ms. Where it is that since a pair
  ///                 that was refused with its motion, the motion is unknown and all tracks end.
  /// @throws InputError when the images do not fit the camera, time does not advance, or numbers of `measured` are not
  ///         finite, out of the ranges of ego_motion.hpp or contradict the times
  Tracking process(const RectifiedPair& pair, double time_s, const std::optional<EgoMotion>& measured = std::nullopt);

 private:
  /// @returns the motion since the last pair whose motion is known
  EgoMotion checked(const EgoMotion& measured, double time_s, std::optional<double> last_call_s) const;

  EgoEstimator ego_;
  Detector detector_;
  TrackKeeper keeper_;
  std::optional<PlanarMotion> unseen_motion_ = PlanarMotion{};  ///< since the detector's last pair, over refused ones
  std::optional<double> last_call_s_;                           ///< time of the last pair, refused or not
};

}  // namespace flies
