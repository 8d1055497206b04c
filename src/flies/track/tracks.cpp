#include "flies/track/tracks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "flies/core/people_obstacles.hpp"
#include "flies/core/quantile.hpp"
#include "flies/track/assignment.hpp"

namespace flies {
namespace {

constexpr double kMaxProbability = 0.98;  // nothing is ever so sure that it could not have gone
constexpr double kLeastAlive = 0.3;       // a track that is less probable, unless less probable ones are reported
constexpr double kMaxPersonLogOdds = 6.0;
constexpr double kNoPersonLogOdds = -0.4;  // the classifier misses some: one silence says little
constexpr double kMaxVerdict = 0.95;       // of one look at a person
constexpr double kMinDepth_m = 0.1;
/// After a longer step anything that moves may be anywhere in view.
constexpr double kLongStep_s = 2.0;
constexpr double kMinHidden = 0.5;  // share of its width behind nearer things that hides a track
constexpr double kHidingDistance_m = 1.0;
constexpr double kSizeGain = 0.25;  // of the newest sighting in the size

constexpr double kSameThing_m = 0.3;  // tracks nearer than this, or than half the width of the wider, may be of one
constexpr double kSameThingVelocity = 9.0;  // squared difference of their velocities over its covariance
constexpr double kSameThingVelocity_mps = 1.0;

constexpr double kMinCornerHeight_m = 0.3;                        // lower ones may be on the road before the thing
constexpr double kCornerSlack_m = 1.0, kCornerSlackShare = 0.05;  // depth of a thing about its near face

/// Standard deviation of values about their median, by the median of their distances.
double scatter(std::vector<double> values, double middle) {
  constexpr double kNormal = 1.4826;
  for (double& value : values) value = std::abs(value - middle);
  return kNormal * upper_median(values);
}

double logit(double p) { return std::log(p / (1.0 - p)); }

/// False for what is nowhere: such a sighting would make whatever it meets just as undefined.
bool is_usable(const Sighting& s) {
  return std::isfinite(s.x_m) && std::isfinite(s.y_m) && std::isfinite(s.width_m) && std::isfinite(s.height_m) &&
         std::isfinite(s.person_probability.value_or(0.0));
}

/// True when nothing but their numbers tells the two apart.
bool are_of_one_thing(const Track& a, const Track& b) {
  const double near_m = std::max(kSameThing_m, 0.5 * std::max(a.width_m, b.width_m));
  if (std::hypot(a.state.x_m - b.state.x_m, a.state.y_m - b.state.y_m) > near_m) return false;
  const double dvx = a.state.vx_mps - b.state.vx_mps, dvy = a.state.vy_mps - b.state.vy_mps;
  if (std::hypot(dvx, dvy) <= kSameThingVelocity_mps) return true;
  const double variance =
      a.state.covariance[2][2] + a.state.covariance[3][3] + b.state.covariance[2][2] + b.state.covariance[3][3];
  return 2.0 * (dvx * dvx + dvy * dvy) <= kSameThingVelocity * variance;
}

/// The state of a thing that went on just as it did: stood still, or moved by its velocity where it is known to move.
GroundState went_on(const Track& track, bool is_known_to_move) {
  GroundState state = track.state;
  if (!is_known_to_move) state.vx_mps = state.vy_mps = 0.0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 2; j < 4; ++j) state.covariance[i][j] = state.covariance[j][i] = 0.0;
  return state;
}

/// Bearings that something covers, as y over x.
std::pair<double, double> tangents(double x_m, double y_m, double width_m) {
  const double range_m = std::max(std::hypot(x_m, y_m), kMinDepth_m), half = 0.5 * width_m / range_m;
  return {y_m / x_m - half, y_m / x_m + half};
}

/// Share of the track's bearings behind nearer sightings.
double hidden_share(const Track& track, std::span<const Sighting> sightings) {
  const double range_m = std::hypot(track.state.x_m, track.state.y_m);
  const auto [low, high] = tangents(track.state.x_m, track.state.y_m, std::max(track.width_m, 0.3));
  double hidden = 0.0;
  for (const auto& s : sightings) {
    if (s.x_m < kMinDepth_m || std::hypot(s.x_m, s.y_m) > range_m - kHidingDistance_m) continue;
    const auto [from, to] = tangents(s.x_m, s.y_m, s.width_m);
    hidden += std::max(0.0, std::min(to, high) - std::max(from, low));
  }
  return hidden / (high - low);
}

}  // namespace

std::vector<Sighting> sightings_of(std::span<const Obstacle> obstacles, std::span<const Pedestrian> people) {
  std::vector<Sighting> sightings;
  for (const auto& obstacle : obstacles) {
    const GroundPoint middle = middle_of(obstacle);
    sightings.push_back({middle.x_m, middle.y_m, obstacle.width_m, obstacle.height_m, obstacle.box, std::nullopt});
  }
  const auto own = obstacles_of_people(obstacles, people);
  for (std::size_t k = 0; k < people.size(); ++k) {
    const Pedestrian& person = people[k];
    if (own[k]) {
      sightings[*own[k]].person_probability = person.probability;
      sightings[*own[k]].box = person.box;
    } else {
      constexpr double kShoulders_m = 0.5;
      sightings.push_back({person.x_m, person.y_m, kShoulders_m, person.height_m, person.box, person.probability});
    }
  }
  return sightings;
}

TrackKeeper::TrackKeeper(const StereoCamera& camera, const TrackOptions& options)
    : camera_(camera), projection_(camera), options_(options) {
  check_camera(camera_, "camera");
  check_options(options_, "options");
}

/// Along the line of sight the error of a disparity grows with the square of range; across it is that of a box's edge.
GroundPosition TrackKeeper::measured(const Sighting& s) const {
  const double range_m = std::max(std::hypot(s.x_m, s.y_m), kMinDepth_m);
  const double along = std::hypot(options_.along_sd_m,
                                  range_m * range_m * options_.disparity_sd_px / (camera_.fx_px * camera_.baseline_m));
  const double across = std::hypot(options_.across_sd_m, options_.across_sd_share * s.width_m, range_m / camera_.fx_px);
  const double c = s.x_m / range_m, n = s.y_m / range_m, a2 = along * along, b2 = across * across;
  return {s.x_m, s.y_m, {{{c * c * a2 + n * n * b2, c * n * (a2 - b2)}, {c * n * (a2 - b2), n * n * a2 + c * c * b2}}}};
}

Point3 TrackKeeper::point_on(const Track& track, double share_of_height) const {
  const auto& [x_m, y_m] = std::pair(track.state.x_m, track.state.y_m);
  return {x_m, y_m, road_.z_m(x_m, y_m) + share_of_height * track.height_m};
}

bool TrackKeeper::is_in_view(const Track& track) const {
  if (!(track.state.x_m > kMinDepth_m) || !std::isfinite(track.state.y_m)) return false;
  const Point3 middle = point_on(track, 0.5);
  if (!(projection_.depth_m(middle) > kMinDepth_m)) return false;
  if (camera_.width_px == 0) return true;
  const double u_px = projection_.project(middle).u_px;
  return u_px >= 0.0 && u_px < camera_.width_px;
}

std::optional<ImageBox> TrackKeeper::predicted_box(const Track& track) const {
  const Point3 at_foot = point_on(track, 0.0), at_head = point_on(track, 1.0);
  const double depth_m = std::min(projection_.depth_m(at_foot), projection_.depth_m(at_head));
  if (!(depth_m > kMinDepth_m)) return std::nullopt;
  const StereoPoint foot = projection_.project(at_foot), head = projection_.project(at_head);
  const double width_px = track.width_m * camera_.fx_px / depth_m;
  return ImageBox{foot.u_px - width_px / 2, head.v_px, width_px, foot.v_px - head.v_px};
}

bool TrackKeeper::is_known_to_move(const Track& track) const {
  return track.moving_sightings >= options_.moving_sightings;
}

std::vector<GroundState> TrackKeeper::predict_all(const EgoMotion& ego) {
  const bool is_long = ego.dt_s > kLongStep_s;
  std::vector<Track> kept;
  std::vector<GroundState> expected;
  for (auto& track : tracks_) {
    // What the pair before shows may be seen in this one, however much later that is.
    if (track.unseen_s > 0.0 && track.unseen_s + ego.dt_s > options_.max_coast_s) continue;
    const GroundState steady = is_long ? predict(went_on(track, is_known_to_move(track)), ego, 0.0) : GroundState{};
    const bool is_person = track.kind == TrackClass::person;
    track.state = predict(track.state, ego, is_person ? options_.person_acceleration_mps2 : options_.acceleration_mps2);
    track.age_s += ego.dt_s;
    track.unseen_s += ego.dt_s;
    if (!is_long && !is_in_view(track)) continue;
    expected.push_back(is_long ? steady : track.state);
    kept.push_back(track);
  }
  tracks_ = std::move(kept);
  return expected;
}

std::vector<int> TrackKeeper::assign(std::span<const GroundState> expected, std::span<const Sighting> sightings) const {
  std::vector<double> costs(expected.size() * sightings.size(), std::numeric_limits<double>::infinity());
  std::vector<double> alone_costs(expected.size(), 0.0);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (std::size_t j = 0; j < sightings.size(); ++j) {
      const Innovation found = innovation(expected[i], measured(sightings[j]));
      if (!(found.squared_distance < options_.gate)) continue;
      // A new track's covariance is wide: the determinant keeps it from taking the sightings of old ones.
      costs[i * sightings.size() + j] = found.squared_distance + found.log_determinant;
      alone_costs[i] = options_.gate + found.log_determinant;
    }
  }
  return assign_optimally(costs, expected.size(), sightings.size(), alone_costs);
}

bool TrackKeeper::has_ended(const Track& track, double dt_s) const {
  if (track.probability < std::min(options_.min_probability, kLeastAlive)) return true;
  const bool is_long = dt_s > kLongStep_s;
  return track.unseen_s > 0.0 && (is_long || track.unseen_s > options_.max_coast_s || !is_in_view(track));
}

/// The median velocity of the corners on a thing: in its box and near its range, so not on what is behind.
std::optional<GroundVelocity> TrackKeeper::velocity_of(const Sighting& s, const EgoMotion& ego) const {
  const double range_m = std::max(std::hypot(s.x_m, s.y_m), kMinDepth_m), c = s.x_m / range_m, n = s.y_m / range_m;
  std::vector<double> along, across;
  for (const auto& corner : ego.corners) {
    if (corner.z_m - road_.z_m(corner.x_m, corner.y_m) < kMinCornerHeight_m || corner.u_px < s.box.u_px ||
        corner.v_px < s.box.v_px || corner.u_px > s.box.u_px + s.box.width_px ||
        corner.v_px > s.box.v_px + s.box.height_px ||
        std::abs(std::hypot(corner.x_m, corner.y_m) - range_m) > kCornerSlack_m + kCornerSlackShare * range_m)
      continue;
    along.push_back(c * corner.vx_mps + n * corner.vy_mps);
    across.push_back(-n * corner.vx_mps + c * corner.vy_mps);
  }
  if (along.size() < static_cast<std::size_t>(options_.min_corners)) return std::nullopt;
  // Two depths make a velocity along the line of sight, two bearings one across it.
  const double one_along = std::numbers::sqrt2 * range_m * range_m * options_.corner_disparity_sd_px /
                           (camera_.fx_px * camera_.baseline_m * ego.dt_s);
  const double one_across =
      std::numbers::sqrt2 * range_m * options_.corner_disparity_sd_px / (camera_.fx_px * ego.dt_s);
  const double v_along = upper_median(along), v_across = upper_median(across);
  const double root = std::sqrt(static_cast<double>(along.size()));
  const auto variance = [&](double one_mps, double scatter_mps) {
    return std::pow(std::hypot(options_.corner_velocity_sd_mps, std::max(one_mps, scatter_mps) / root), 2);
  };
  const double a2 = variance(one_along, scatter(along, v_along)), b2 = variance(one_across, scatter(across, v_across));
  return GroundVelocity{c * v_along - n * v_across,
                        n * v_along + c * v_across,
                        {{{c * c * a2 + n * n * b2, c * n * (a2 - b2)}, {c * n * (a2 - b2), n * n * a2 + c * c * b2}}}};
}

void TrackKeeper::see(Track& track, const Sighting& sighting, const EgoMotion& ego) const {
  track.state = update(track.state, measured(sighting));
  if (const auto velocity = velocity_of(sighting, ego)) track.state = update(track.state, *velocity);
  const double odds = track.probability / (1.0 - track.probability) * options_.seen_odds;
  track.probability = std::min(kMaxProbability, odds / (1.0 + odds));
  const double verdict = sighting.person_probability
                             ? logit(std::clamp(*sighting.person_probability, 1.0 - kMaxVerdict, kMaxVerdict))
                             : kNoPersonLogOdds;
  track.person_log_odds = std::clamp(track.person_log_odds + verdict, -kMaxPersonLogOdds, kMaxPersonLogOdds);
  track.width_m += kSizeGain * (sighting.width_m - track.width_m);
  track.height_m += kSizeGain * (sighting.height_m - track.height_m);
  track.box = sighting.box;
  track.unseen_s = 0.0;
  ++track.sightings;
}

void TrackKeeper::miss(Track& track, std::span<const Sighting> sightings) const {
  const bool is_hidden = hidden_share(track, sightings) >= kMinHidden;
  const double seen = is_hidden ? options_.hidden_detection_probability : options_.detection_probability;
  track.probability = track.probability * (1.0 - seen) / (1.0 - track.probability * seen);
  if (const auto box = predicted_box(track)) track.box = *box;
}

Track TrackKeeper::start(const Sighting& s, const EgoMotion& ego) {
  Track track;
  track.id = next_id_++;
  track.probability = options_.first_probability;
  const GroundPosition position = measured(s);
  track.state.x_m = position.x_m;
  track.state.y_m = position.y_m;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) track.state.covariance[i][j] = position.covariance[i][j];
    track.state.covariance[i + 2][i + 2] = options_.start_speed_mps * options_.start_speed_mps;
  }
  if (const auto velocity = velocity_of(s, ego)) track.state = update(track.state, *velocity);
  track.person_log_odds = s.person_probability
                              ? logit(std::clamp(*s.person_probability, 1.0 - kMaxVerdict, kMaxVerdict))
                              : kNoPersonLogOdds;
  track.width_m = s.width_m;
  track.height_m = s.height_m;
  track.box = s.box;
  track.sightings = 1;
  return track;
}

/// A filter takes errors for independent. What all sightings share (the part of the thing that is seen, what surrounds
/// it in the patches that match) stays, however often it is seen.
Track TrackKeeper::reported(const Track& track) const {
  Track found = track;
  const double share = options_.common_sd_share * options_.common_sd_share;
  const Covariance2 common = measured({track.state.x_m, track.state.y_m, track.width_m, 0.0, {}, {}}).covariance;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) found.state.covariance[i][j] += share * common[i][j];
  return found;
}

/// One jump of a sighting looks like motion; several in a row that agree are.
void TrackKeeper::judge_motion(Track& track) const {
  const double prior = track.kind == TrackClass::person ? options_.person_moving_prior : options_.moving_prior;
  track.velocity = likely_velocity(track.state, prior, options_.start_speed_mps);
  if (track.unseen_s == 0.0) {
    constexpr double kMoves = 0.5;
    track.moving_sightings = track.velocity.moving_probability > kMoves ? track.moving_sightings + 1 : 0;
  }
  if (!is_known_to_move(track)) track.velocity.vx_mps = track.velocity.vy_mps = 0.0;
}

/// Two sightings of one thing start two tracks; once only one of them is seen, the older number goes on with its state.
void TrackKeeper::join_doubles() {
  for (auto& seen : tracks_) {
    if (seen.unseen_s > 0.0) continue;
    for (auto& unseen : tracks_) {
      if (unseen.unseen_s == 0.0 || unseen.sightings == 0 || !are_of_one_thing(seen, unseen)) continue;
      if (unseen.id < seen.id) {
        seen.id = unseen.id;
        seen.age_s = unseen.age_s;
        seen.probability = std::max(seen.probability, unseen.probability);
        seen.moving_sightings = std::max(seen.moving_sightings, unseen.moving_sightings);
      }
      unseen.sightings = 0;  // to be removed
    }
  }
  std::erase_if(tracks_, [](const Track& t) { return t.sightings == 0; });
}

std::vector<Track> TrackKeeper::step(const EgoMotion& ego, std::span<const Sighting> given, const RoadPlane& road) {
  road_ = road;
  std::vector<Sighting> sightings;
  std::ranges::copy_if(given, std::back_inserter(sightings), is_usable);
  if (!ego.is_known) tracks_.clear();
  const auto expected = predict_all(ego);
  const auto assigned = assign(expected, sightings);

  std::vector<bool> taken(sightings.size(), false);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (assigned[i] < 0) {
      miss(tracks_[i], sightings);
      continue;
    }
    const auto j = static_cast<std::size_t>(assigned[i]);
    taken[j] = true;
    see(tracks_[i], sightings[j], ego);
  }
  std::erase_if(tracks_, [&](const Track& t) { return has_ended(t, ego.dt_s); });
  for (std::size_t j = 0; j < sightings.size(); ++j)
    if (!taken[j]) tracks_.push_back(start(sightings[j], ego));
  join_doubles();

  for (auto& track : tracks_) {
    track.kind = track.person_log_odds > 0.0 ? TrackClass::person : TrackClass::other;
    judge_motion(track);
  }
  std::vector<Track> found;
  for (const auto& track : tracks_)
    if (track.probability >= options_.min_probability) found.push_back(reported(track));
  std::stable_sort(found.begin(), found.end(), [](const Track& a, const Track& b) {
    return std::hypot(a.state.x_m, a.state.y_m) < std::hypot(b.state.x_m, b.state.y_m);
  });
  return found;
}

}  // namespace flies
