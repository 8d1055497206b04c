#include "flies/pipeline/tracker.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "flies/core/error.hpp"

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

/// One motion and then the other, where both are known.
std::optional<PlanarMotion> joined(const std::optional<PlanarMotion>& first, const std::optional<PlanarMotion>& next) {
  if (!first || !next) return std::nullopt;
  return first->then(*next);
}

/// Clocks of two sensors differ a little, and stamps of pairs have the jitter of their transfer.
bool agree(double dt_s, double step_s) {
  constexpr double kShare = 0.1, kJitter_s = 0.02;
  return std::abs(dt_s - step_s) <= kShare * step_s + kJitter_s;
}

}  // namespace

Tracker::Tracker(const StereoCamera& camera, const DetectorOptions& detector, const TrackerOptions& options,
                 std::shared_ptr<const PeopleClassifier> classifier)
    : ego_(camera, options.ego), detector_(camera, detector, std::move(classifier)), keeper_(camera, options.track) {}

EgoMotion Tracker::checked(const EgoMotion& measured, double time_s, std::optional<double> last_call_s) const {
  if (!measured.is_known) return measured;
  detail::check_ego_motion(measured, "measured motion");
  const auto before_s = ego_.last_time_s();
  if (!before_s || agree(measured.dt_s, time_s - *before_s)) return measured;
  if (!last_call_s || !(time_s > *last_call_s) || !agree(measured.dt_s, time_s - *last_call_s))
    throw InputError(
        "measured motion", "dt_s",
        fmt::format("found {:g} s, but the pair before was {:g} s earlier", measured.dt_s, time_s - *before_s));
  EgoMotion lost;  // it is that since a pair that was refused, and the one before that is not known
  lost.dt_s = time_s - *before_s;
  return lost;
}

Tracking Tracker::process(const RectifiedPair& pair, double time_s, const std::optional<EgoMotion>& measured) {
  Tracking t;
  t.time_s = time_s;
  ego_.check_time(time_s);
  const auto last_call_s = std::exchange(last_call_s_, time_s);
  if (measured) {
    t.ego = checked(*measured, time_s, last_call_s);
    ego_.skip(time_s);
  }
  const auto seen_motion = [&] { return joined(unseen_motion_, planar_motion(t.ego)); };
  try {
    t.detection = measured ? detector_.process(pair, seen_motion()) : detector_.process(pair, [&] {
      t.ego = timed(t.ego_ms, [&] { return ego_.follow(pair, time_s); });
      return seen_motion();
    });
  } catch (...) {
    // Tracks and what the detector remembers move with the camera, whatever became of the pair.
    if (measured || t.ego.dt_s > 0.0) {
      keeper_.step(t.ego, {});
      unseen_motion_ = seen_motion();
    }
    throw;
  }
  unseen_motion_ = PlanarMotion{};
  const auto sightings = sightings_of(t.detection.obstacles, t.detection.pedestrians);
  t.tracks = timed(t.track_ms, [&] { return keeper_.step(t.ego, sightings, t.detection.road.plane); });
  return t;
}

}  // namespace flies
