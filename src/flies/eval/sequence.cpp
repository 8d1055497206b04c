#include "flies/eval/sequence.hpp"

#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "flies/core/error.hpp"

namespace flies {
namespace {

void measure_ego(const EgoMotion& truth, const EgoMotion& found, EgoMeasures& m) {
  if (!truth.is_known) return;
  ++m.pairs;
  m.lost += !found.is_known;
  if (!found.is_known) return;
  const double speed_mps = std::hypot(truth.vx_mps, truth.vy_mps);
  if (speed_mps >= kMinEgoSpeed_mps)
    m.speed_errors.push_back(std::abs(std::hypot(found.vx_mps, found.vy_mps) / speed_mps - 1.0));
  m.yaw_rate_errors_rps.push_back(std::abs(found.yaw_rate_rps - truth.yaw_rate_rps));
}

}  // namespace

bool is_followable(const Dataset& dataset) {
  return dataset.is_sequence && dataset.pairs.size() > 1 && dataset.times_s.size() == dataset.pairs.size() &&
         dataset.true_ego.size() == dataset.pairs.size();
}

SequenceResult evaluate_sequence(const Dataset& dataset, std::size_t first, std::size_t last,
                                 const DetectorOptions& detector_options, const TrackerOptions& tracker_options,
                                 std::shared_ptr<const PeopleClassifier> classifier, const EvaluationOptions& options,
                                 const std::function<void(std::size_t)>& progress) {
  if (!is_followable(dataset))
    throw InputError("truth", "times and motions of the pairs",
                     "not known, expected a KITTI drive with oxts from its first pair on, or a drawn sequence");
  SequenceResult result;
  std::optional<Tracker> tracker;
  std::optional<Detector> single;
  std::vector<TrackedTruth> frames;
  for (std::size_t i = first; i < last; ++i) {
    TruthFrame frame = dataset.load(i);
    if (!tracker) {
      tracker.emplace(frame.camera, detector_options, tracker_options, classifier);
      single.emplace(frame.camera, detector_options, nullptr);
    }
    const auto start = std::chrono::steady_clock::now();
    Tracking tracking = tracker->process(frame.images.view(), dataset.times_s[i]);
    result.times_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    const ScanTruth sectors = scan_truth(frame.truth, frame.camera, options.match, options.sectors);
    result.scan.push_back(score_scan(sectors, tracking.detection.scan, options.match, options.sectors));
    result.single_scan.push_back(
        score_scan(sectors, single->process(frame.images.view()).scan, options.match, options.sectors));
    const EgoMotion true_ego = i == first ? EgoMotion{} : dataset.true_ego[i];
    measure_ego(true_ego, tracking.ego, result.ego);
    frame.truth.lidar = frame.truth.map = {};  // scored already, and large
    frames.push_back({std::move(frame.truth), true_ego, std::move(tracking.tracks), dataset.times_s[i]});
    if (progress) progress(frames.size());
  }
  result.pairs = frames.size();
  if (!frames.empty()) result.duration_s = frames.back().time_s - frames.front().time_s;
  result.tracks =
      measure_tracks(frames, {.min_range_m = options.match.min_range_m, .max_range_m = options.match.max_range_m});
  return result;
}

}  // namespace flies
