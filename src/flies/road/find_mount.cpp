#include "flies/road/find_mount.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "flies/core/pair_check.hpp"
#include "flies/core/quantile.hpp"
#include "flies/core/usable_pair.hpp"
#include "flies/road/ground_plane.hpp"
#include "flies/road/road.hpp"
#include "flies/road/see_places.hpp"

namespace flies {
namespace {

/// A mount that deviates by less is the one that was told: the road of each pair makes up for that.
constexpr double kSameHeight = 0.08;
constexpr double kSameTilt_rad = radians(2.0);

/// A road that is steeper in the told axes does not confirm them: it may be the camera that tilts.
constexpr double kMaxSlope = 0.044;

/// Shears of the right image: what nearly all mounts need, and what cameras near the ground need.
constexpr double kSmallShear = 0.5, kLargeShear = 2.0;
constexpr double kLowestMount_m = 0.2;

/// Of the probes of the road, those on it: 0.2 to 0.7 in good pairs, at most 0.08 with a wrong mount.
constexpr double kConfirmed = 0.2;
/// With so many, the told mount gives way only to much better evidence.
constexpr double kLikely = 0.1;

/// A mount beside the told one takes its place when it has so many times the probes on the road.
constexpr double kMoreRoad = 1.5;

/// Support that a plane needs to be the ground, as a share of the places matched: 0.04 to 0.5 where much of it is seen,
/// at most 0.012 where none is (images turned by 180 degrees, but for floors that are 5 m away or stand upright).
constexpr double kGroundShare = 0.015;
constexpr double kMuchGroundShare = 0.08;
/// The same of images of half the size, where the ground is as told: 0.05 and more on dark asphalt, next to nothing
/// where it is elsewhere.
constexpr double kGroundShareInHalves = 0.04;
/// Of turned images to be the ground, and so many times that of the images as they are.
constexpr double kTurnedShare = 0.03, kTurnedOverGiven = 3.0;
/// Below this, places in the upper third of the images are not so much nearer that they may stand on their heads: 1.2
/// at most in images that do not.
constexpr double kNearerAbove = 1.2;
/// The told mount stays when its support is this share of the best.
constexpr double kAsGood = 0.6;

/// Mounts of several pairs that differ by less from their median agree.
constexpr double kAgreeingHeight = 0.12;
constexpr double kAgreeingTilt_rad = radians(3.0);

/// Higher planes are found, but not believed: a ceiling, a roof.
constexpr double kHighest_m = 3.6;

/// Scatter beyond which a plane says nothing.
constexpr double kMaxHeightDeviation = 0.05;
constexpr double kMaxTiltDeviation_rad = radians(1.0);
/// Places on a plane that lie at one distance are of a wall.
constexpr double kLeastDepthRatio = 1.2;

MountLimits around(const CameraMount& told) {
  return {told.height_m * (1.0 - kSameHeight), told.height_m * (1.0 + kSameHeight), told.pitch_rad - kSameTilt_rad,
          told.pitch_rad + kSameTilt_rad,      told.roll_rad - kSameTilt_rad,       told.roll_rad + kSameTilt_rad};
}

/// The told mount at other tilts: the first tries of the search around it.
std::vector<GroundPlane> planes_around(const CameraMount& told, double scale_px_m) {
  constexpr int kSteps = 8;
  std::vector<GroundPlane> planes;
  for (int step = -kSteps; step <= kSteps; ++step)
    planes.push_back(
        plane_below({told.height_m, told.pitch_rad + step * kSameTilt_rad / kSteps, told.roll_rad}, scale_px_m));
  return planes;
}

/// What one pair says.
struct Vote {
  std::size_t places = 0;
  double told_support = 0.0;                  ///< of the best plane around the told mount
  std::optional<CameraMount> near_told = {};  ///< of that plane, where it is sure enough
  double support = 0.0;                       ///< of the best plane
  std::optional<CameraMount> mount = {};      ///< of that plane, likewise
};

/// The mount above a plane that is sure enough.
std::optional<CameraMount> sure_mount(const SeenPlaces& seen, const GroundPlane& plane, double highest_m = kHighest_m) {
  if (depth_ratio_on(seen, plane) < kLeastDepthRatio) return std::nullopt;
  const MountDeviation deviation = mount_deviation(seen, plane);
  const CameraMount mount = mount_above(plane, seen.scale_px_m);
  if (mount.height_m <= highest_m && deviation.height_share < kMaxHeightDeviation &&
      deviation.pitch_rad < kMaxTiltDeviation_rad && deviation.roll_rad < kMaxTiltDeviation_rad)
    return mount;
  return std::nullopt;
}

Vote vote_of(const SeenPlaces& seen, const CameraMount& told) {
  Vote vote;
  vote.places = seen.places.size();
  const auto near_told = planes_around(told, seen.scale_px_m);
  if (const auto found = fit_ground(seen, around(told), near_told)) {
    vote.support = vote.told_support = found->support;
    vote.near_told = sure_mount(seen, found->plane);
  }
  const auto best = fit_ground(seen, {}, near_told);
  if (!best) return vote;
  vote.support = std::max(best->support, vote.told_support);
  vote.mount = sure_mount(seen, best->plane);
  return vote;
}

double share_of(const Vote& vote) { return vote.support / std::max<double>(1.0, static_cast<double>(vote.places)); }

/// The vote at half of the weight, in ascending order of a member of their mounts.
double weighted_median(std::vector<Vote> votes, double CameraMount::*member) {
  std::sort(votes.begin(), votes.end(),
            [&](const Vote& a, const Vote& b) { return (*a.mount).*member < (*b.mount).*member; });
  double total = 0.0, sum = 0.0;
  for (const auto& vote : votes) total += vote.support;
  for (const auto& vote : votes) {
    sum += vote.support;
    if (sum >= total / 2.0) return (*vote.mount).*member;
  }
  return (*votes.back().mount).*member;
}

/// The mount that most of the votes with much ground agree on.
std::optional<CameraMount> agreed_mount(const std::vector<Vote>& all, double min_share) {
  std::vector<Vote> votes;
  std::copy_if(all.begin(), all.end(), std::back_inserter(votes),
               [&](const Vote& vote) { return vote.mount && share_of(vote) >= min_share; });
  if (votes.empty()) return std::nullopt;
  const CameraMount middle{weighted_median(votes, &CameraMount::height_m),
                           weighted_median(votes, &CameraMount::pitch_rad),
                           weighted_median(votes, &CameraMount::roll_rad)};
  const auto agreeing = std::count_if(votes.begin(), votes.end(), [&](const Vote& vote) {
    return std::abs(vote.mount->height_m / middle.height_m - 1.0) < kAgreeingHeight &&
           std::abs(vote.mount->pitch_rad - middle.pitch_rad) < kAgreeingTilt_rad &&
           std::abs(vote.mount->roll_rad - middle.roll_rad) < kAgreeingTilt_rad;
  });
  if (2 * static_cast<std::size_t>(agreeing) <= votes.size()) return std::nullopt;
  return middle;
}

/// How far below the cameras there is ground, deeper than where it is looked for: baselines of 40 times their length,
/// as of inches taken for metres, put it there.
double deep_ground_m(const std::vector<SeenPlaces>& each) {
  constexpr double kDeepest_m = 150.0;
  std::vector<Vote> votes;
  for (const auto& seen : each)
    if (const auto best = fit_ground(seen, {.min_height_m = kHighest_m, .max_height_m = kDeepest_m}))
      votes.push_back(
          {.places = seen.places.size(), .support = best->support, .mount = sure_mount(seen, best->plane, kDeepest_m)});
  const auto mount = agreed_mount(votes, kMuchGroundShare);
  return mount ? mount->height_m : 0.0;
}

/// The images turned by 180 degrees.
SeenPlaces turned(SeenPlaces seen) {
  for (auto& place : seen.places) {
    place.across = -place.across;
    place.down = -place.down;
  }
  return seen;
}

/// What all pairs say.
struct Evidence {
  std::vector<SeenPlaces> each;
  std::vector<Vote> votes;
  double support = 0.0, told_support = 0.0;
  std::size_t places = 0;

  double share(double of) const { return places == 0 ? 0.0 : of / static_cast<double>(places); }
  bool is_as_told() const { return told_support >= kAsGood * support; }
  bool has_mount() const {
    return std::ranges::any_of(votes, [](const Vote& vote) { return vote.mount.has_value(); });
  }
  bool is_clear() const {
    return is_as_told() ? share(support) >= kGroundShare : share(support) >= kMuchGroundShare && has_mount();
  }
  /// Likewise, of halved images: a plane takes more of what lies on none.
  bool is_clear_in_halves() const { return is_clear() && share(support) >= kGroundShareInHalves; }
};

Evidence gather(std::span<const RectifiedPair> pairs, const StereoCamera& camera, double max_shear, int max_width_px) {
  Evidence evidence;
  for (const auto& pair : pairs) {
    evidence.each.push_back(see_places(pair, camera, max_shear, max_width_px));
    const Vote& vote = evidence.votes.emplace_back(vote_of(evidence.each.back(), camera.mount));
    evidence.places += vote.places;
    evidence.support += vote.support;
    evidence.told_support += vote.told_support;
  }
  return evidence;
}

/// Less than which hardly any place has: things as far away as a street's end are seen somewhere.
double farthest_px(const std::vector<SeenPlaces>& each, double scale_px_m) {
  constexpr double kHardlyAny = 0.02;
  std::vector<double> parallaxes_px;
  for (const auto& seen : each) {
    const double factor = scale_px_m / seen.scale_px_m;  // the places may be those of halved images
    for (const auto& place : seen.places) parallaxes_px.push_back(factor * place.parallax_px);
  }
  return parallaxes_px.empty() ? 0.0 : quantile(parallaxes_px, kHardlyAny);
}

std::vector<SeenPlaces> see_all(std::span<const RectifiedPair> pairs, const StereoCamera& camera) {
  std::vector<SeenPlaces> each;
  for (const auto& pair : pairs) each.push_back(see_places(pair, camera, kSmallShear, kPlacesWidth_px));
  return each;
}

/// With the shears that nearly all mounts need; with more, which let chance match more as well, where that shows more.
Evidence gather_sheared(std::span<const RectifiedPair> pairs, const StereoCamera& camera, int max_width_px) {
  Evidence evidence = gather(pairs, camera, kSmallShear, max_width_px);
  const double large = std::min(kLargeShear, camera.baseline_m / kLowestMount_m);
  if (evidence.is_clear() || large <= kSmallShear) return evidence;
  Evidence steep = gather(pairs, camera, large, max_width_px);
  return steep.share(steep.support) > evidence.share(evidence.support) ? steep : evidence;
}

/// Or in images of half the size, where these show it clearly: soft ground is lost in the noise of large ones.
Evidence gather_clear(std::span<const RectifiedPair> pairs, const StereoCamera& camera) {
  Evidence evidence = gather_sheared(pairs, camera, kPlacesWidth_px);
  const bool is_large = std::ranges::any_of(pairs, [](const RectifiedPair& pair) {
    return pair.left.width_px > kCoarsePlacesWidth_px && pair.left.width_px <= kPlacesWidth_px;
  });
  if (evidence.is_clear() || !is_large) return evidence;
  Evidence coarse = gather_sheared(pairs, camera, kCoarsePlacesWidth_px);
  const bool shows_more = coarse.share(coarse.support) > evidence.share(evidence.support);
  return shows_more && coarse.is_clear_in_halves() ? coarse : evidence;
}

/// Whether a plane of the turned images is the ground, and hardly any of the images as they are.
bool stands_on_its_head(const Evidence& evidence) {
  if (evidence.share(evidence.support) >= kMuchGroundShare) return false;
  std::vector<Vote> votes;
  double support = 0.0;
  for (const auto& seen : evidence.each) support += votes.emplace_back(vote_of(turned(seen), CameraMount{})).support;
  return support >= kTurnedOverGiven * evidence.support && agreed_mount(votes, kTurnedShare).has_value();
}

/// Whether what is seen above is nearer than what is seen below, in most pairs: so it is where images stand on their
/// heads, and a ceiling can be where the road was told to be.
bool is_nearer_above(std::span<const RectifiedPair> pairs, const StereoCamera& camera) {
  const auto nearer = std::count_if(pairs.begin(), pairs.end(), [&](const RectifiedPair& pair) {
    const PairEvidence seen = gather_pair_evidence(pair, camera);
    return seen.lower_px > 0.0 && seen.upper_px > kNearerAbove * seen.lower_px;
  });
  return 2 * static_cast<std::size_t>(nearer) > pairs.size();
}

/// The road where the mount says it is.
struct RoadsSeen {
  double share = 0.0;  ///< of the probes in all pairs, those on a road that was found
  double slope = 0.0;  ///< of these roads, the median
};

RoadsSeen see_roads(std::span<const RectifiedPair> pairs, const StereoCamera& camera) {
  const Projection projection(camera);
  std::size_t probes = 0, on_road = 0;
  std::vector<double> slopes;
  for (const auto& pair : pairs) {
    const RoadResult road = estimate_road(pair, projection, {});
    probes += road.probes.size();
    if (!road.found || std::abs(road.plane.slope) > kMaxSlope) continue;
    on_road += static_cast<std::size_t>(
        std::count_if(road.probes.begin(), road.probes.end(), [](const RoadProbe& probe) { return probe.inlier; }));
    slopes.push_back(road.plane.slope);
  }
  const double share = probes == 0 ? 0.0 : static_cast<double>(on_road) / static_cast<double>(probes);
  return {share, median(std::move(slopes)).value_or(0.0)};
}

/// What the pairs say of mounts around the told one.
std::vector<Vote> votes_near_told(const Evidence& evidence) {
  std::vector<Vote> votes;
  for (Vote vote : evidence.votes) {
    vote.mount = vote.near_told;
    vote.support = vote.told_support;
    votes.push_back(vote);
  }
  return votes;
}

/// The mount beside the told one that shows more of the road's probes on the road: a few centimetres or a degree are
/// more than the search for the road of each pair makes up for where the road is bare.
std::optional<CameraMount> nearby_mount(const Evidence& evidence, std::span<const RectifiedPair> pairs,
                                        const StereoCamera& camera, double told_road) {
  const auto mount = agreed_mount(votes_near_told(evidence), kGroundShare);
  if (!mount) return std::nullopt;
  StereoCamera moved = camera;
  moved.mount = *mount;
  const double share = see_roads(pairs, moved).share;
  return share > kMoreRoad * told_road && share >= kLikely ? mount : std::nullopt;
}

}  // namespace

double MountFinding::rise_px() const {
  if (!is_replaced) return scale_px_m * slope / told.height_m;
  return plane_below(mount, scale_px_m).ahead_px - plane_below(told, scale_px_m).ahead_px;
}

MountFinding find_mount(std::span<const RectifiedPair> given, const StereoCamera& camera) {
  check_camera(camera, "camera");
  MountFinding finding{.told = camera.mount,
                       .mount = camera.mount,
                       .baseline_m = camera.baseline_m,
                       .scale_px_m = camera.fx_px * camera.baseline_m};
  std::vector<RectifiedPair> pairs;
  for (const auto& pair : given) pairs.push_back(detail::usable_pair(pair));
  const auto [told_road, slope] = see_roads(pairs, camera);
  finding.slope = slope;
  finding.is_confirmed = told_road >= kConfirmed;
  if (finding.is_confirmed && !is_nearer_above(pairs, camera)) {
    if (finding.rise_px() >= kDoubtfulRise_px)
      finding.farthest_px = farthest_px(see_all(pairs, camera), finding.scale_px_m);
    return finding;
  }

  const Evidence evidence = gather_clear(pairs, camera);
  finding.ground_share = evidence.share(evidence.support);
  finding.farthest_px = farthest_px(evidence.each, finding.scale_px_m);
  if (stands_on_its_head(evidence)) {
    finding.is_confirmed = false;
    finding.is_upside_down = true;
  }
  if (finding.is_confirmed || finding.is_upside_down) return finding;

  const bool is_as_told = evidence.is_as_told();
  const double least_share = told_road >= kLikely ? kMuchGroundShare : kGroundShare;
  const auto mount =
      is_as_told ? nearby_mount(evidence, pairs, camera, told_road) : agreed_mount(evidence.votes, least_share);
  finding.is_confirmed = is_as_told && !mount && finding.ground_share >= kGroundShare;
  finding.is_replaced = mount.has_value();
  if (mount) finding.mount = *mount;
  if (finding.is_confirmed)
    if (const auto near_told = agreed_mount(votes_near_told(evidence), kGroundShare))
      finding.slope = std::tan(near_told->pitch_rad - finding.told.pitch_rad);
  if (!mount && !finding.is_confirmed) finding.deep_ground_m = deep_ground_m(evidence.each);
  return finding;
}

}  // namespace flies
