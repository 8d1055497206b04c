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
  std::optional<std::uint64_t> last_id = {};
  bool was_missed = false;       ///< in view and not found since it was last found
  double since_s = 0.0;          ///< first pair in view
  int moving = 0, standing = 0;  ///< pairs with a true velocity
  std::optional<double> report_s = {}, velocity_s = {};
};

/// Squared error over the covariance of two numbers of the state, from the first of them on.
double normalised(const Track& track, std::size_t from, double error_1, double error_2) {
  const auto& p = track.state.covariance;
  const double a = p[from][from], b = p[from][from + 1], c = p[from + 1][from + 1];
  return (c * error_1 * error_1 - 2 * b * error_1 * error_2 + a * error_2 * error_2) / (a * c - b * b);
}

/// The near face in the middle of the bearings that the footprint covers: where a track of it should be.
std::optional<Point3> seen_place(const LabelledObject& object) {
  constexpr double kWholeInView = 0.99;
  const Footprint& f = object.footprint;
  if (object.occlusion != 0 || object.in_view_fraction < kWholeInView) return std::nullopt;
  const double c = std::cos(f.yaw_rad), s = std::sin(f.yaw_rad);
  double low_rad = 0.0, high_rad = 0.0;  // from the bearing of the centre
  const double centre_rad = std::atan2(f.y_m, f.x_m);
  for (const double along : {-f.length_m / 2, f.length_m / 2})
    for (const double across : {-f.width_m / 2, f.width_m / 2}) {
      const double x_m = f.x_m + c * along - s * across, y_m = f.y_m + s * along + c * across;
      const double bearing_rad = std::atan2(y_m, x_m) - centre_rad;
      low_rad = std::min(low_rad, bearing_rad);
      high_rad = std::max(high_rad, bearing_rad);
    }
  const double middle_rad = centre_rad + (low_rad + high_rad) / 2;
  const auto range_m = near_face_range_m(f, middle_rad);
  if (!range_m) return std::nullopt;
  return Point3{*range_m * std::cos(middle_rad), *range_m * std::sin(middle_rad), 0.0};
}

/// Sums up when things had their first track and velocity.
void add_first_times(const std::map<int, History>& histories, TrackMeasures& m) {
  for (const auto& [track, history] : histories) {
    if (history.report_s) m.first_report_s.push_back(*history.report_s - history.since_s);
    m.never_reported += !history.report_s;
    if (history.moving <= history.standing) continue;
    if (history.velocity_s) m.first_velocity_s.push_back(*history.velocity_s - history.since_s);
    m.never_with_velocity += !history.velocity_s;
  }
}

}  // namespace

TrackMeasures measure_tracks(std::span<const TrackedTruth> frames, const TrackMatchOptions& options) {
  TrackMeasures m;
  std::map<int, History> histories;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto& [truth, ego, tracks, time_s] = frames[i];
    for (const auto& object : truth.objects) {
      const double range_m = near_range_m(object.footprint);
      if (!object.visible || range_m < options.min_range_m || range_m > options.max_range_m) continue;
      ++m.objects;
      History& history = histories.try_emplace(object.track, History{.since_s = time_s}).first->second;
      const auto velocity = true_velocity(frames, i, object.track);
      const bool moves = velocity && velocity->speed_mps() > options.moving_mps;
      if (velocity) ++(moves ? history.moving : history.standing);
      const Track* track = track_of(object, tracks, history.last_id, options);
      if (track == nullptr) {
        history.was_missed = history.last_id.has_value();
        continue;
      }
      ++m.found;
      if (history.last_id && track->id != *history.last_id) ++m.identity_switches;
      if (history.was_missed) ++m.fragments;
      history.last_id = track->id;
      history.was_missed = false;
      if (!history.report_s) history.report_s = time_s;
      const bool is_settled = track->age_s >= options.settled_s;
      if (const auto place = seen_place(object); place && is_settled)
        m.position_nees.push_back(normalised(*track, 0, track->state.x_m - place->x_m, track->state.y_m - place->y_m));
      if (!velocity) continue;
      const double error =
          std::hypot(track->velocity.vx_mps - velocity->vx_mps, track->velocity.vy_mps - velocity->vy_mps);
      if (moves && !history.velocity_s && error <= options.right_mps) history.velocity_s = time_s;
      if (!is_settled) continue;
      m.velocity_nees.push_back(
          normalised(*track, 2, track->state.vx_mps - velocity->vx_mps, track->state.vy_mps - velocity->vy_mps));
      if (moves) {
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
  add_first_times(histories, m);
  return m;
}

}  // namespace flies
