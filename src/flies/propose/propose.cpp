#include "flies/propose/propose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "flies/core/convert.hpp"
#include "flies/core/error.hpp"
#include "flies/propose/scan_stretches.hpp"

namespace flies {
namespace {

/// Width over height of the window (Li 2010, IV: 48 x 96).
constexpr double kWindowAspect = 0.5;
/// A hundred times what the presets ask for; more would take minutes and gigabytes in a street.
constexpr std::size_t kMaxRoisPerObstacle = 10'000;
/// Closer to the camera than this no person fits into any image.
constexpr double kMinDepth_m = 0.5;
/// Windows that agree to less than this share of their height are one and the same: nothing is merged.
constexpr double kLeastMergeStep = 1e-9;

std::vector<double> person_heights(const ProposeOptions& options) {
  if (options.heights == 1) return {std::sqrt(options.min_height_m * options.max_height_m)};
  std::vector<double> heights_m;
  for (int i = 0; i < options.heights; ++i)
    heights_m.push_back(options.min_height_m *
                        std::pow(options.max_height_m / options.min_height_m, i / (options.heights - 1.0)));
  return heights_m;
}

/// 0, 1, -1, 2, -2, ..., -count: the best guess first, for of two like boxes the first is kept.
std::vector<int> alternating(int count) {
  std::vector<int> steps{0};
  for (int i = 1; i <= count; ++i) steps.insert(steps.end(), {i, -i});
  return steps;
}

int lateral_steps(double width_m, double step_m, const ProposeOptions& options) {
  const double reach_m = std::min(std::max(width_m, 0.0) / 2.0 + options.lateral_margin_m, options.max_lateral_m);
  return saturated<int>(std::floor(reach_m / step_m + 1e-9));
}

bool may_be_person(const Obstacle& obstacle, const Projection& projection, const ProposeOptions& options) {
  const bool finite = std::isfinite(obstacle.x_m) && std::isfinite(obstacle.y_m) && std::isfinite(obstacle.width_m);
  return finite && obstacle.height_m >= options.min_obstacle_height_m &&
         projection.depth_m({obstacle.x_m, obstacle.y_m, obstacle.ground_z_m}) >= kMinDepth_m;
}

/// The upright person of this height at this place.
Roi roi_at(const Point3& feet, double height_m, const Projection& projection, double person_share) {
  const StereoPoint foot = projection.project(feet);
  const StereoPoint head = projection.project({feet.x_m, feet.y_m, feet.z_m + height_m});
  const double person_px = foot.v_px - head.v_px;
  const double window_px = person_px / person_share;
  const double centre_u_px = (foot.u_px + head.u_px) / 2.0, centre_v_px = (foot.v_px + head.v_px) / 2.0;
  const auto box_about_centre = [&](double tall_px) {
    const double wide_px = tall_px * kWindowAspect;
    return ImageBox{centre_u_px - wide_px / 2.0, centre_v_px - tall_px / 2.0, wide_px, tall_px};
  };
  return {box_about_centre(window_px), box_about_centre(person_px), feet.x_m, feet.y_m, height_m, 0};
}

/// The same person one or more steps to the left and down in the image. Feet stay where the obstacle's range has them.
Roi shifted(Roi roi, int left, int down, double range_m, double step_m, double step_px) {
  for (ImageBox* box : {&roi.window, &roi.person}) {
    box->u_px -= left * step_px;
    box->v_px += down * step_px;
  }
  const double left_m = left * step_m;  // across the line of sight
  const double x_m = roi.x_m - left_m * roi.y_m / range_m, y_m = roi.y_m + left_m * roi.x_m / range_m;
  roi.x_m = x_m;
  roi.y_m = y_m;
  return roi;
}

bool touches_image(const ImageBox& box, int width_px, int height_px) {
  return box.u_px < width_px && box.v_px < height_px && box.u_px + box.width_px > 0.0 && box.v_px + box.height_px > 0.0;
}

/// Windows of about one size. The grid of their places belongs to the class, not to the window, or like windows would
/// not meet.
struct SizeClass {
  std::int64_t number = 0;
  double cell_px = 0.0;

  SizeClass(double height_px, double merge_step) {
    if (!(merge_step > 0.0)) return;
    const double nearest = std::round(std::log(height_px) / std::log1p(merge_step));
    number = saturated<std::int64_t>(nearest);
    cell_px = merge_step * std::pow(1.0 + merge_step, nearest);
  }
};

/// Windows that agree to about a `merge_step` of their height in place and size share a key.
struct MergeKey {
  std::int64_t size = 0, across = 0, down = 0;

  bool operator==(const MergeKey&) const = default;
};

MergeKey merge_key(const ImageBox& window, const SizeClass& size) {
  const auto cell = [&](double middle_px) { return saturated<std::int64_t>(std::round(middle_px / size.cell_px)); };
  return {size.number, cell(window.u_px + window.width_px / 2.0), cell(window.v_px + window.height_px / 2.0)};
}

/// Keys seen so far, in one piece of memory: a set of the library allocates a node for each.
class SeenKeys {
 public:
  /// @returns whether the key is new
  bool insert(const MergeKey& key) {
    if (2 * (count_ + 1) > slots_.size()) grow();
    Slot& slot = slot_of(key);
    if (slot.is_taken) return false;
    slot = {key, true};
    ++count_;
    return true;
  }

 private:
  struct Slot {
    MergeKey key;
    bool is_taken = false;
  };
  static constexpr std::size_t kSlotsAtFirst = 2048;  // a power of two, as are all sizes

  Slot& slot_of(const MergeKey& key) {
    constexpr std::uint64_t kMixer = 0x9E3779B97F4A7C15U;  // the golden ratio, as in Knuth's multiplicative hashing
    std::uint64_t hash = 0;
    for (const std::int64_t part : {key.size, key.across, key.down})
      hash = (hash ^ static_cast<std::uint64_t>(part)) * kMixer;
    std::size_t i = static_cast<std::size_t>(hash >> 32U) & (slots_.size() - 1);
    while (slots_[i].is_taken && slots_[i].key != key) i = (i + 1) & (slots_.size() - 1);
    return slots_[i];
  }

  void grow() {
    const std::vector<Slot> old = std::exchange(slots_, std::vector<Slot>(std::max(kSlotsAtFirst, 2 * slots_.size())));
    for (const Slot& slot : old)
      if (slot.is_taken) slot_of(slot.key) = slot;
  }

  std::vector<Slot> slots_;
  std::size_t count_ = 0;
};

}  // namespace

double step_between_boxes(const ProposeOptions& options) { return options.step > 0.0 ? options.step : 1.0 / 12.0; }

std::size_t max_rois_per_obstacle(const ProposeOptions& options) {
  constexpr double kAnyWidth_m = 1e9;
  std::size_t count = 0;
  for (const double height_m : person_heights(options)) {
    const double step_m = step_between_boxes(options) * height_m / options.person_share;
    const auto sideways = static_cast<std::size_t>(lateral_steps(kAnyWidth_m, step_m, options));
    count += (2 * sideways + 1) * static_cast<std::size_t>(2 * options.vertical_shifts + 1);
  }
  return count;
}

void check_propose_options(const ProposeOptions& options, const std::string& source) {
  check_options(options, source);
  if (options.min_height_m > options.max_height_m)
    throw InputError(source, "propose.min_height_m",
                     fmt::format("found {}, expected at most propose.max_height_m, which is {}", options.min_height_m,
                                 options.max_height_m));
  if (const std::size_t rois = max_rois_per_obstacle(options); rois > kMaxRoisPerObstacle)
    throw InputError(
        source, "propose.step",
        fmt::format("asks for up to {} boxes an obstacle, expected at most {}", rois, kMaxRoisPerObstacle));
}

std::vector<Roi> propose_rois(std::span<const Obstacle> obstacles, const Scan& scan, const Projection& projection,
                              const RoadPlane& road, int image_width_px, int image_height_px,
                              const ProposeOptions& options) {
  check_propose_options(options, "propose options");
  std::vector<Obstacle> places(obstacles.begin(), obstacles.end());
  for (const Obstacle& stretch : scan_stretches(obstacles, scan, road, options)) places.push_back(stretch);
  const auto heights_m = person_heights(options);
  const auto downward = alternating(options.vertical_shifts);
  const double step = step_between_boxes(options);
  std::vector<Roi> rois;
  SeenKeys seen;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Obstacle& obstacle = places[i];
    if (!may_be_person(obstacle, projection, options)) continue;
    const Point3 feet{obstacle.x_m, obstacle.y_m, road.z_m(obstacle.x_m, obstacle.y_m)};
    if (projection.depth_m(feet) < kMinDepth_m) continue;
    for (const double height_m : heights_m) {
      const Roi on_road = roi_at(feet, height_m, projection, options.person_share);
      if (on_road.person.height_px < options.min_person_px) continue;
      const double step_m = step * height_m / options.person_share;
      const double step_px = step * on_road.window.height_px, range_m = std::hypot(feet.x_m, feet.y_m);
      const SizeClass size(on_road.window.height_px, options.merge_step);
      for (const int left : alternating(lateral_steps(obstacle.width_m, step_m, options)))
        for (const int down : downward) {
          Roi roi = shifted(on_road, left, down, range_m, step_m, step_px);
          roi.obstacle = i;
          if (touches_image(roi.person, image_width_px, image_height_px) &&
              (options.merge_step < kLeastMergeStep || seen.insert(merge_key(roi.window, size))))
            rois.push_back(roi);
        }
    }
  }
  return rois;
}

}  // namespace flies
