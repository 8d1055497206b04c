#include "flies/scan/evidence.hpp"

#include <algorithm>
#include <cmath>

namespace flies {
namespace {

/// A fly's patch is wider than a column: its neighbours hear of it, too.
constexpr double kNeighbourShare = 0.5;

/// The support of something seen fades out over this many tolerances.
constexpr double kFade = 1.3;

}  // namespace

void Evidence::add(int column, const Seen& seen) {
  const auto& evidence = options_.evidence;
  const int disparities = labels_ - 1;
  const std::size_t first = start(column);
  float* cost = against_.data() + first;
  // The first disparity number at a parallax of at most this.
  const auto number = [&](double parallax_px) {
    return static_cast<int>(std::ceil(std::clamp(nearest_px_ - parallax_px, 0.0, static_cast<double>(disparities))));
  };
  const auto add_from_to = [&](int from, int to, double value) {
    if (from >= to) return;
    cost[from] += static_cast<float>(value);
    if (to < disparities) cost[to] -= static_cast<float>(value);
  };
  const double tolerance_px = evidence.tolerance_px + evidence.tolerance_share * std::max(0.0, seen.parallax_px);

  // Nearer obstacles that this line of sight would have met between the road and the height of a body.
  if (seen.road_parallax_px > 0.0) {
    const double share = evidence.body_height_m / camera_height_m_;
    const int nearest = share < 1.0 ? number(seen.road_parallax_px / (1.0 - share)) : 0;
    const int end = std::min(number(std::max(seen.parallax_px + tolerance_px, seen.road_parallax_px)), disparities);
    add_from_to(nearest, end, evidence.seen_through * seen.weight);
  }

  const double height_m = height_above_road_m(camera_height_m_, seen.road_parallax_px, seen.parallax_px);
  if (!(seen.parallax_px > 0.0 && height_m >= options_.z_min_m && height_m <= options_.z_max_m)) return;
  // Farther obstacles, and none at all, which this hides or denies.
  add_from_to(std::min(number(seen.parallax_px - tolerance_px), disparities), disparities,
              evidence.seen_before * seen.weight);
  cost[disparities] += static_cast<float>(evidence.seen_before * seen.weight);
  float* support = support_.data() + first;
  const double fade_px = kFade * tolerance_px;
  const int end = std::min(number(seen.parallax_px - fade_px), disparities);
  for (int k = number(seen.parallax_px + fade_px); k < end; ++k)
    support[k] +=
        static_cast<float>(seen.weight * std::max(0.0, 1.0 - std::abs(nearest_px_ - k - seen.parallax_px) / fade_px));
}

void Evidence::collect(const CellLayout& layout, std::span<const CellPoint> points, const Population& flies,
                       const Projection& projection, const RoadPlane& road, const ScanOptions& options) {
  options_ = options;
  columns_ = layout.columns;
  labels_ = layout.disparities + 1;
  nearest_px_ = layout.nearest_px - projection.disparity_offset_px();
  camera_height_m_ = projection.height_m() - road.height_m;
  const std::size_t size = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(labels_);
  const auto slope = [&](int column) {
    const Point3 point = projection.triangulate(
        {layout.middle_u_px(column), projection.cy_px(), projection.disparity_offset_px() + 1.0});
    return point.y_m / point.x_m;
  };
  depth_parallax_ = projection.depth_at_disparity(projection.disparity_offset_px() + 1.0);
  first_slope_ = slope(0);
  slope_step_ = slope(1) - first_slope_;
  against_.assign(size, 0.0F);
  cost_.resize(size);
  support_.assign(size, 0.0F);

  for (int band = 0; band < layout.bands; ++band)
    for (int column = 0; column < columns_; ++column) {
      const std::size_t i = layout.cell(band, column);
      if (points[i].certainty > 0.0F) add(column, {points[i].parallax_px, layout.road_px[i], points[i].certainty});
    }
  for (std::size_t i = 0; options.evidence.fly > 0.0 && i < flies.size(); ++i) {
    if (!(flies.fitness[i] > 0.0F)) continue;
    const Point3 point = flies.point(i);
    if (!(projection.depth_m(point) > 0.0)) continue;
    const StereoPoint image = projection.project(point);
    const double weight = options.evidence.fly * flies.fitness[i];
    const double place = image.u_px / kernels::kCellColumns;
    if (!(place >= 0.0 && place < columns_)) continue;
    const int column = static_cast<int>(place);
    const Seen seen{image.disparity_px - projection.disparity_offset_px(),
                    projection.road_parallax_px(image.u_px, image.v_px, road), weight};
    add(column, seen);
    for (const int beside : {column - 1, column + 1})
      if (beside >= 0 && beside < columns_)
        add(beside, {seen.parallax_px, seen.road_parallax_px, kNeighbourShare * weight});
  }

  for (int column = 0; column < columns_; ++column) {
    float* against = against_.data() + start(column);
    for (int k = 1; k + 1 < labels_; ++k) against[k] += against[k - 1];
  }
  for (int column = 0; column < columns_; ++column) price(column);
}

void Evidence::price(int column) {
  const auto& evidence = options_.evidence;
  const std::size_t first = start(column), none = first + static_cast<std::size_t>(labels_) - 1;
  for (std::size_t k = first; k < none; ++k)
    cost_[k] =
        against_[k] + static_cast<float>(evidence.obstacle -
                                         evidence.support * std::min<double>(support_[k], evidence.enough_support));
  cost_[none] = against_[none];
}

void Evidence::recall(const Evidence& before, const PlanarMotion& motion) {
  const auto& evidence = options_.evidence;
  if (!(evidence.memory > 0.0) || before.columns_ < 2 || before.labels_ < 3 || columns_ < 2) return;
  const double c = std::cos(motion.turn_rad), s = std::sin(motion.turn_rad);
  const int none = labels_ - 1, last_before = before.labels_ - 2;
  const auto column_before = [&](double slope) {
    const double place = (slope - before.first_slope_) / before.slope_step_;
    return place > -0.5 && place < before.columns_ - 0.5 ? static_cast<int>(std::lround(place)) : -1;
  };
  for (int column = 0; column < columns_; ++column) {
    float* against = against_.data() + start(column);
    float* support = support_.data() + start(column);
    const double doubt = 1.0 - *std::max_element(support, support + none) / evidence.recall_below;
    if (!(doubt > 0.0)) continue;
    const double share = doubt * evidence.memory;
    const double slope = first_slope_ + column * slope_step_;
    // Of a place at a parallax p, depth and offset to the left at the pair before, times p.
    const double ahead = depth_parallax_ * (c - s * slope), aside = depth_parallax_ * (s + c * slope);
    for (int k = 0; k < none; ++k) {
      const double parallax_px = nearest_px_ - k;
      const double depth = motion.forward_m * parallax_px + ahead;
      if (!(depth > 0.0)) continue;
      const int from = column_before((motion.left_m * parallax_px + aside) / depth);
      const double place = before.nearest_px_ - depth_parallax_ * parallax_px / depth;
      if (from < 0 || place < 0.0) continue;
      const int low = std::min(static_cast<int>(place), last_before), high = std::min(low + 1, last_before);
      const double part = std::min(place - low, 1.0);
      const auto blend = [&](const std::vector<float>& values) {
        const float* of_column = values.data() + before.start(from);
        return static_cast<float>(share * std::lerp(of_column[low], of_column[high], part));
      };
      against[k] += blend(before.against_);
      support[k] += blend(before.support_);
    }
    if (const int from = ahead > 0.0 ? column_before(aside / ahead) : -1; from >= 0)
      against[none] += static_cast<float>(
          share * before.against_[before.start(from) + static_cast<std::size_t>(before.labels_) - 1]);
    price(column);
  }
}

}  // namespace flies
