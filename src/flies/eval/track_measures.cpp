#include "flies/eval/track_measures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace flies {
namespace {

const LabelledObject* object_of(const FrameTruth& truth, int track) {
  const auto at = std::find_if(truth.objects.begin(), truth.objects.end(),
                               [&](const LabelledObject& object) { return object.track == track; });
  return at == truth.objects.end() ? nullptr : &*at;
}

struct Velocity {
  double vx_mps = 0.0, vy_mps = 0.0;
  double speed_mps() const { return std::hypot(vx_mps, vy_mps); }
};

/// Over ground, in the axes of frame `i`, from where the object is one pair before and after.
std::optional<Velocity> true_velocity(std::span<const TrackedTruth> frames, std::size_t i, int track) {
  if (i == 0 || i + 1 >= frames.size()) return std::nullopt;
  const EgoMotion &here = frames[i].true_ego, &next = frames[i + 1].true_ego;
  const auto* before = object_of(frames[i - 1].truth, track);
  const auto* after = object_of(frames[i + 1].truth, track);
  if (before == nullptr || after == nullptr || !here.is_known || !next.is_known) return std::nullopt;
  const Point3 from = here.current_from_previous({before->footprint.x_m, before->footprint.y_m, 0.0});
  const Point3 to = next.current_from_previous.inverse()({after->footprint.x_m, after->footprint.y_m, 0.0});
  const double dt_s = here.dt_s + next.dt_s;
  return Velocity{(to.x_m - from.x_m) / dt_s, (to.y_m - from.y_m) / dt_s};
}

double reported_speed(const Track& track) { return std::hypot(track.velocity.vx_mps, track.velocity.vy_mps); }

bool is_of(const Track& track, const LabelledObject& object, const TrackMatchOptions& options) {
  const double range_m = std::hypot(track.state.x_m, track.state.y_m);
  return distance_to_footprint_m(object.footprint, track.state.x_m, track.state.y_m) <=
         options.gap_m + options.gap_share * range_m;
}

/// The track of an object: the one it had, as long as that is near it, else the nearest to its footprint.
const Track* track_of(const LabelledObject& object, std::span<const Track> tracks, std::optional<std::uint64_t> last_id,
                      const TrackMatchOptions& options) {
  const Track* nearest = nullptr;
  double nearest_m = 0.0;
  for (const auto& track : tracks) {
    if (!is_of(track, object, options)) continue;
    if (track.id == last_id) return &track;
    const double distance_m = distance_to_footprint_m(object.footprint, track.state.x_m, track.state.y_m);
    if (nearest != nullptr && distance_m >= nearest_m) continue;
    nearest = &track;
    nearest_m = distance_m;
  }
  return nearest;
}

struct History {
  std::optional<std::uint64_t> last_id;
  bool was_missed = false;  ///< in view and not found since it was last found
};

}  // namespace

TrackMeasures measure_tracks(std::span<const TrackedTruth> frames, const TrackMatchOptions& options) {
  TrackMeasures m;
  std::map<int, History> histories;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto& [truth, ego, tracks] = frames[i];
    for (const auto& object : truth.objects) {
      const double range_m = near_range_m(object.footprint);
      if (!object.visible || range_m < options.min_range_m || range_m > options.max_range_m) continue;
      ++m.objects;
      History& history = histories[object.track];
      const Track* track = track_of(object, tracks, history.last_id, options);
      if (track == nullptr) {
        history.was_missed = history.last_id.has_value();
        continue;
      }
      ++m.found;
      if (history.last_id && track->id != *history.last_id) ++m.identity_switches;
      if (history.was_missed) ++m.fragments;
      history = {track->id, false};
      const auto velocity = true_velocity(frames, i, object.track);
      if (!velocity || track->age_s < options.settled_s) continue;
      const double error =
          std::hypot(track->velocity.vx_mps - velocity->vx_mps, track->velocity.vy_mps - velocity->vy_mps);
      if (velocity->speed_mps() > options.moving_mps) {
        m.moving_errors_mps.push_back(error);
      } else {
        m.standing_errors_mps.push_back(error);
        ++m.standing;
        m.false_motion += reported_speed(*track) > options.moving_mps;
      }
    }
    for (const auto& track : tracks) {
      const bool is_labelled = std::any_of(truth.objects.begin(), truth.objects.end(),
                                           [&](const LabelledObject& object) { return is_of(track, object, options); });
      if (is_labelled || track.age_s < options.settled_s) continue;
      ++m.unlabelled;
      m.unlabelled_moving += reported_speed(track) > options.moving_mps;
    }
  }
  return m;
}

}  // namespace flies
