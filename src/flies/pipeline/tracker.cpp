#include "flies/pipeline/tracker.hpp"

#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

namespace flies {
namespace {

template <class Run>
auto timed(double& elapsed_ms, const Run& run) {
  const auto start = std::chrono::steady_clock::now();
  auto result = run();
  elapsed_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return result;
}

/// What of the camera's motion lies in the plane of the road; nothing when it is not known.
std::optional<PlanarMotion> planar_motion(const EgoMotion& ego) {
  if (!ego.is_known) return std::nullopt;
  const RigidMotion previous_from_current = ego.current_from_previous.inverse();
  const auto& r = previous_from_current.rotation;
  return PlanarMotion{previous_from_current.shift.x_m, previous_from_current.shift.y_m, std::atan2(r[1][0], r[0][0])};
}

}  // namespace

Tracker::Tracker(const StereoCamera& camera, const DetectorOptions& detector, const TrackerOptions& options,
                 std::shared_ptr<const PeopleClassifier> classifier)
    : ego_(camera, options.ego), detector_(camera, detector, std::move(classifier)), keeper_(camera, options.track) {}

Tracking Tracker::process(const RectifiedPair& pair, double time_s, const std::optional<EgoMotion>& measured) {
  Tracking t;
  t.time_s = time_s;
  ego_.check(pair, time_s);
  if (measured) t.ego = *measured;
  try {
    t.detection = measured ? detector_.process(pair, planar_motion(t.ego)) : detector_.process(pair, [&] {
      t.ego = timed(t.ego_ms, [&] { return ego_.follow(pair, time_s); });
      return planar_motion(t.ego);
    });
  } catch (...) {
    // Tracks move with the camera, whatever became of the pair.
    if (measured) ego_.skip(pair, time_s);
    if (t.ego.dt_s > 0.0) keeper_.step(t.ego, {});
    throw;
  }
  if (measured) ego_.skip(pair, time_s);
  const auto sightings = sightings_of(t.detection.obstacles, t.detection.pedestrians);
  t.tracks = timed(t.track_ms, [&] { return keeper_.step(t.ego, sightings, t.detection.road.plane); });
  return t;
}

}  // namespace flies
