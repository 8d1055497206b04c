#pragma once

#include <span>
#include <vector>

#include "flies/ego/ego_motion.hpp"
#include "flies/eval/truth.hpp"
#include "flies/track/tracks.hpp"

namespace flies {

struct TrackMatchOptions {
  double min_range_m = 5.0, max_range_m = 40.0;  ///< of objects that count, nearest point of the footprint
  double gap_m = 0.75, gap_share = 0.05;         ///< a track this near a footprint, plus this share of range, is of it
  double moving_mps = 1.0;                       ///< objects and tracks that are faster move
  double settled_s = 0.5;                        ///< velocities count once a track is this old
  double right_mps = 1.0;                        ///< a moving thing has its velocity once the error is this small
};

/// One pair: the truth, the true motion since the pair before, and what was reported.
struct TrackedTruth {
  FrameTruth truth;
  EgoMotion true_ego;
  std::vector<Track> tracks;
  double time_s = 0.0;
};

/// How well objects were followed over a sequence.
struct TrackMeasures {
  int objects = 0;                          ///< visible labelled objects, a pair each
  int found = 0;                            ///< of those, with a track
  int identity_switches = 0;                ///< an object's track has another number than the last one it had
  int fragments = 0;                        ///< an object in view is found again after it was not
  std::vector<double> moving_errors_mps;    ///< of the velocity vector, objects that move
  std::vector<double> standing_errors_mps;  ///< the same of labelled objects that stand
  int standing = 0;                         ///< settled tracks on labelled objects that stand
  int false_motion = 0;                     ///< of those, reported faster than `moving_mps`
  int unlabelled = 0;                       ///< settled tracks on no label
  int unlabelled_moving = 0;           ///< of those, reported faster than `moving_mps`; unlabelled things may well move
  std::vector<double> first_report_s;  ///< from the first pair with the object in view and range to its first track
  std::vector<double> first_velocity_s;  ///< things that mostly move: the same to the first velocity within `right_mps`
  int never_reported = 0;                ///< objects without any track
  int never_with_velocity = 0;           ///< things that mostly move and whose velocity was never right
  /// Squared errors over covariances, settled tracks: 2 on average where the covariances have the right size. Positions
  /// are of the near face in the middle of the bearings that the object covers, where it is seen whole and unhidden.
  std::vector<double> position_nees, velocity_nees;
};

/// True velocities over ground come from the labels of the pairs before and after and the true motion of the camera.
TrackMeasures measure_tracks(std::span<const TrackedTruth> frames, const TrackMatchOptions& options = {});

}  // namespace flies
