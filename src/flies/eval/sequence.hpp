#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "flies/classify/people_classifier.hpp"
#include "flies/eval/dataset.hpp"
#include "flies/eval/evaluation.hpp"
#include "flies/eval/scan_score.hpp"
#include "flies/eval/track_measures.hpp"
#include "flies/pipeline/tracker.hpp"

namespace flies {

/// How well the camera's motion was known.
struct EgoMeasures {
  int pairs = 0;                            ///< with a true motion
  int lost = 0;                             ///< of those, without an estimate
  std::vector<double> speed_errors;         ///< |.|, as part of the true speed, where that is `kMinEgoSpeed_mps`
  std::vector<double> yaw_rate_errors_rps;  ///< |.|
};
inline constexpr double kMinEgoSpeed_mps = 1.0;

/// What following a whole sequence gave.
struct SequenceResult {
  std::size_t pairs = 0;
  double duration_s = 0.0;
  TrackMeasures tracks;
  EgoMeasures ego;
  std::vector<ScanScore> scan;         ///< of the tracker, whose scan remembers; a pair each
  std::vector<ScanScore> single_scan;  ///< of the same detector without the camera's motion, so without memory
  std::vector<double> times_ms;        ///< from a pair to its tracks
};

/// True when times and motions of its pairs are known, so that tracks can be measured.
bool is_followable(const Dataset& dataset);

/// Lets a tracker follow the pairs `first` to `last` (not included), from images alone, and measures its tracks, its
/// ego-motion and its scan against the truth. The same detector, pair by pair, is run beside it for its scan.
/// @param progress called with the number of pairs done
/// @throws InputError from reading the pairs, and when the dataset is not followable
SequenceResult evaluate_sequence(const Dataset& dataset, std::size_t first, std::size_t last,
                                 const DetectorOptions& detector, const TrackerOptions& tracker,
                                 std::shared_ptr<const PeopleClassifier> classifier,
                                 const EvaluationOptions& options = {},
                                 const std::function<void(std::size_t)>& progress = {});

}  // namespace flies
