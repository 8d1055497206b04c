#include "flies/concentrate/whole_obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "flies/concentrate/board_box.hpp"

namespace flies {
namespace {

/// A sector of the scan shows an obstacle when their ranges differ by less than this and a share of the range.
constexpr double kSameRange_m = 0.75, kSameRangeShare = 0.05;

/// The confidence of a sector that surely shows its surface.
constexpr double kSure = 0.5;

/// What the scan alone sees stands at least as high as its lowest obstacles, and no more is known.
constexpr double kNewHeight_m = 0.5;

/// Two obstacles that share more than this of the narrower one's bearings are one, however wide.
constexpr double kSameBearings = 0.5;

/// An obstacle while it grows.
struct Thing {
  Obstacle obstacle;
  double right_rad = 0.0, left_rad = 0.0;
  double near_m = 0.0, near_rad = 0.0;  ///< its near face: range, and bearing where that was seen
  int first = -1, last = -1;            ///< the sectors that show it, from the right; -1 when none does

  double width_m() const { return near_m * (left_rad - right_rad); }
};

class Surfaces {
 public:
  Surfaces(const Scan& scan, const WholeOptions& options) : scan_(scan), options_(options) {}

  int size() const { return static_cast<int>(scan_.size()); }
  bool is_obstacle(int i) const {
    return i >= 0 && i < size() && scan_.states[static_cast<std::size_t>(i)] == SectorState::obstacle;
  }
  double range_m(int i) const { return scan_.ranges_m[static_cast<std::size_t>(i)]; }
  double confidence(int i) const { return scan_.confidence[static_cast<std::size_t>(i)]; }
  double right_rad(int i) const {
    return scan_.angle_min_rad + (static_cast<double>(i) - 0.5) * scan_.angle_increment_rad;
  }
  double left_rad(int i) const { return right_rad(i) + scan_.angle_increment_rad; }
  double middle_rad(int i) const { return right_rad(i) + 0.5 * scan_.angle_increment_rad; }
  int sector_at(double angle_rad) const {
    const double place = (angle_rad - scan_.angle_min_rad) / scan_.angle_increment_rad;
    return static_cast<int>(std::lround(std::clamp(place, -1.0, size() + 0.0)));
  }

  /// True when the sector and the next one to the left show one surface.
  bool goes_on(int i) const {
    if (!is_obstacle(i) || !is_obstacle(i + 1)) return false;
    const double a_m = range_m(i), b_m = range_m(i + 1);
    return std::abs(a_m - b_m) <= options_.step_m + options_.step_share * std::min(a_m, b_m);
  }

 private:
  const Scan& scan_;
  const WholeOptions& options_;
};

double same_range_m(double range_m) { return kSameRange_m + kSameRangeShare * range_m; }

/// Lets a thing grow along its surface.
void grow(Thing& thing, const Surfaces& surfaces, const WholeOptions& options) {
  const double tolerance_m = same_range_m(thing.near_m);
  const auto shows = [&](int i, double behind_m) {
    return surfaces.is_obstacle(i) && surfaces.range_m(i) >= thing.near_m - tolerance_m &&
           surfaces.range_m(i) <= thing.near_m + behind_m;
  };
  const int left_end = std::min(surfaces.size() - 1, surfaces.sector_at(thing.left_rad));
  for (int i = std::max(0, surfaces.sector_at(thing.right_rad)); i <= left_end; ++i)
    if (shows(i, tolerance_m)) {
      if (thing.first < 0) thing.first = i;
      thing.last = i;
    }
  if (thing.first < 0) return;
  const auto fits = [&](int first, int last) {
    return thing.near_m * (surfaces.left_rad(last) - surfaces.right_rad(first)) <= options.max_width_m;
  };
  // A surface ends where it was last seen for sure; what lies between may be plain.
  int first = thing.first, last = thing.last;
  for (int i = first - 1; surfaces.goes_on(i) && shows(i, options.depth_m) && fits(i, last); --i)
    if (surfaces.confidence(i) >= kSure) first = i;
  for (int i = last + 1; surfaces.goes_on(i - 1) && shows(i, options.depth_m) && fits(first, i); ++i)
    if (surfaces.confidence(i) >= kSure) last = i;
  thing.first = first;
  thing.last = last;
  thing.right_rad = std::min(thing.right_rad, surfaces.right_rad(thing.first));
  thing.left_rad = std::max(thing.left_rad, surfaces.left_rad(thing.last));
}

bool are_one(const Thing& a, const Thing& b, const Surfaces& surfaces, const WholeOptions& options) {
  if (a.first < 0 || b.first < 0 || std::abs(a.near_m - b.near_m) > options.join_depth_m) return false;
  const double near_m = std::min(a.near_m, b.near_m);
  const double shared_rad = std::min(a.left_rad, b.left_rad) - std::max(a.right_rad, b.right_rad);
  if (-shared_rad * near_m > options.gap_m) return false;
  const double width_m = near_m * (std::max(a.left_rad, b.left_rad) - std::min(a.right_rad, b.right_rad));
  const double narrower_rad = std::min(a.left_rad - a.right_rad, b.left_rad - b.right_rad);
  if (width_m > options.max_width_m && shared_rad < kSameBearings * narrower_rad) return false;
  for (int i = std::min(a.last, b.last); i < std::max(a.first, b.first); ++i)
    if (!surfaces.goes_on(i)) return false;
  return true;
}

void join(Thing& a, const Thing& b) {
  if (b.near_m < a.near_m) {
    a.near_m = b.near_m;
    a.near_rad = b.near_rad;
  }
  a.right_rad = std::min(a.right_rad, b.right_rad);
  a.left_rad = std::max(a.left_rad, b.left_rad);
  a.first = std::min(a.first, b.first);
  a.last = std::max(a.last, b.last);
  a.obstacle.height_m = std::max(a.obstacle.height_m, b.obstacle.height_m);
  a.obstacle.score += b.obstacle.score;
}

/// Joins until no two are one.
void join_all(std::vector<Thing>& things, const Surfaces& surfaces, const WholeOptions& options) {
  for (std::size_t i = 0; i < things.size(); ++i)
    for (std::size_t j = i + 1; j < things.size();) {
      if (!are_one(things[i], things[j], surfaces, options)) {
        ++j;
        continue;
      }
      join(things[i], things[j]);
      things.erase(things.begin() + static_cast<std::ptrdiff_t>(j));
      i = 0;  // the larger thing may reach others, also those before it
      j = 1;
    }
}

/// Surfaces, or stretches of them up to the largest width, that no thing stands on.
std::vector<Thing> unclaimed(const std::vector<Thing>& things, const Surfaces& surfaces, const WholeOptions& options) {
  std::vector<bool> claimed(static_cast<std::size_t>(surfaces.size()), false);
  for (const auto& thing : things)
    for (int i = std::max(0, surfaces.sector_at(thing.right_rad));
         i <= std::min(surfaces.size() - 1, surfaces.sector_at(thing.left_rad)); ++i)
      claimed[static_cast<std::size_t>(i)] = true;
  const auto is_free = [&](int i) { return surfaces.is_obstacle(i) && !claimed[static_cast<std::size_t>(i)]; };
  std::vector<Thing> found;
  for (int first = 0; first < surfaces.size(); ++first) {
    if (!is_free(first)) continue;
    Thing thing;
    thing.near_m = surfaces.range_m(first);
    double confidence = surfaces.confidence(first);
    int last = first;
    for (; is_free(last + 1) && surfaces.goes_on(last); ++last) {
      const double near_m = std::min(thing.near_m, surfaces.range_m(last + 1));
      if (near_m * (surfaces.left_rad(last + 1) - surfaces.right_rad(first)) > options.max_width_m) break;
      thing.near_m = near_m;
      confidence += surfaces.confidence(last + 1);
    }
    thing.first = first;
    thing.last = last;
    thing.right_rad = surfaces.right_rad(first);
    thing.left_rad = surfaces.left_rad(last);
    thing.near_rad = 0.5 * (thing.right_rad + thing.left_rad);
    thing.obstacle.height_m = kNewHeight_m;
    const int sectors = last - first + 1;
    first = last;
    if (thing.width_m() >= options.min_new_width_m && confidence / sectors >= options.min_new_confidence &&
        thing.near_m <= options.max_new_range_m)
      found.push_back(thing);
  }
  return found;
}

/// How far the surface of a thing reaches behind its nearest point, along the line of sight to its middle, metres.
/// Between its first and last sector others may stand before or behind it.
double depth_m(const Thing& thing, const Surfaces& surfaces, double middle_rad, const WholeOptions& options) {
  if (thing.first < 0) return 0.0;
  const double nearest_m = thing.near_m - same_range_m(thing.near_m), farthest_m = thing.near_m + options.depth_m;
  double near_m = std::numeric_limits<double>::infinity(), far_m = 0.0;
  for (int i = thing.first; i <= thing.last; ++i) {
    if (!surfaces.is_obstacle(i) || surfaces.range_m(i) < nearest_m || surfaces.range_m(i) > farthest_m) continue;
    const double along_m = surfaces.range_m(i) * std::cos(surfaces.middle_rad(i) - middle_rad);
    near_m = std::min(near_m, along_m);
    far_m = std::max(far_m, along_m);
  }
  return std::max(0.0, far_m - near_m);
}

Obstacle finish(const Thing& thing, const Surfaces& surfaces, const Projection& projection, const RoadPlane& road,
                const WholeOptions& options) {
  Obstacle obstacle = thing.obstacle;
  const double middle_rad = 0.5 * (thing.right_rad + thing.left_rad);
  obstacle.range_m = thing.near_m;
  obstacle.x_m = thing.near_m * std::cos(thing.near_rad);
  obstacle.y_m = thing.near_m * std::sin(thing.near_rad);
  obstacle.width_m = thing.width_m();
  obstacle.middle_offset_m = thing.near_m * (middle_rad - thing.near_rad);
  obstacle.depth_m = depth_m(thing, surfaces, middle_rad, options);
  obstacle.ground_z_m = road.z_m(obstacle.x_m, obstacle.y_m);
  obstacle.box = board_box({thing.near_m, thing.right_rad, thing.left_rad, obstacle.height_m}, projection, road);
  return obstacle;
}

}  // namespace

std::vector<Obstacle> whole_obstacles(std::span<const Obstacle> obstacles, const Scan& scan,
                                      const Projection& projection, const RoadPlane& road,
                                      const WholeOptions& options) {
  check_options(options, "whole options");
  if (!options.enable || scan.empty()) return {obstacles.begin(), obstacles.end()};
  const Surfaces surfaces(scan, options);
  std::vector<Thing> things;
  for (const auto& obstacle : obstacles) {
    const double angle_rad = std::atan2(obstacle.y_m, obstacle.x_m);
    const double half_rad = 0.5 * obstacle.width_m / obstacle.range_m;
    things.push_back({obstacle, angle_rad - half_rad, angle_rad + half_rad, obstacle.range_m, angle_rad, -1, -1});
    grow(things.back(), surfaces, options);
  }
  join_all(things, surfaces, options);
  const auto added = unclaimed(things, surfaces, options);
  things.insert(things.end(), added.begin(), added.end());
  std::vector<Obstacle> whole;
  whole.reserve(things.size());
  for (const auto& thing : things) whole.push_back(finish(thing, surfaces, projection, road, options));
  std::stable_sort(whole.begin(), whole.end(), [](const auto& a, const auto& b) { return a.range_m < b.range_m; });
  return whole;
}

}  // namespace flies
