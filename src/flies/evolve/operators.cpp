#include "flies/evolve/operators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "flies/core/convert.hpp"
#include "flies/core/error.hpp"
#include "flies/evolve/kernels/scouts.hpp"
#include "flies/evolve/kernels/spawn.hpp"

namespace flies {
namespace {

/// Draws that may miss the habitat before the operator settles for less; bounds the time of every child.
constexpr int kMaxDraws = 16;

/// The width of the default patch: contrast within it is what the fitness will see.
constexpr int kContrastWindow_px = kernels::kMinWidth_px;

/// Spread of steered flies about the near face, as a share of the range: as uncertain as a good stereo range.
constexpr double kSteeringDepthSpread = 0.03;

/// Where nothing lives and nothing is scored: the projection of points behind the camera.
constexpr StereoPoint kNowhere = {-1.0, -1.0, std::numeric_limits<double>::infinity()};

/// Uniform in image column, disparity and height above the road.
StereoPoint draw_in_image(const Habitat& habitat, const RandomWords& words) {
  const auto& field = habitat.field();
  return habitat.at_height(uniform(words[0], 0.0, habitat.left().width_px - 1),
                           uniform(words[1], field.z_min_m, field.z_max_m),
                           uniform(words[2], habitat.projection().disparity_at_depth(field.x_max_m),
                                   habitat.projection().disparity_at_depth(field.x_min_m)));
}

/// Uniform in image column and height above the road, disparity at equal ratios.
StereoPoint draw_in_ratios(const Habitat& habitat, const RandomWords& words) {
  const auto& field = habitat.field();
  return habitat.at_height(uniform(words[0], 0.0, habitat.left().width_px - 1),
                           uniform(words[1], field.z_min_m, field.z_max_m),
                           habitat.disparity_at_ratio(uniform(words[2])));
}

StereoPoint project(const Habitat& habitat, const Point3& point) {
  return habitat.projection().depth_m(point) > 0.0 ? habitat.projection().project(point) : kNowhere;
}

StereoPoint draw_in_space(const Habitat& habitat, const RandomWords& words) {
  const auto& field = habitat.field();
  const double x_m = uniform(words[0], field.x_min_m, field.x_max_m);
  const double y_m = uniform(words[1], field.y_min_m, field.y_max_m);
  return project(habitat, {x_m, y_m, habitat.road().z_m(x_m, y_m) + uniform(words[2], field.z_min_m, field.z_max_m)});
}

StereoPoint draw_fly(const Habitat& habitat, InitialDistribution distribution, const RandomWords& words) {
  switch (distribution) {
    case InitialDistribution::ratios:
      return draw_in_ratios(habitat, words);
    case InitialDistribution::image:
      return draw_in_image(habitat, words);
    case InitialDistribution::space:
      return draw_in_space(habitat, words);
  }
  return kNowhere;
}

/// Standard deviation of image noise that rows are compared with, grey levels; keeps flat rows from looking alike.
constexpr double kRowNoise_gray = 2.0;
constexpr double kRowNoise = kernels::kRowColumns * kernels::kRowColumns * kRowNoise_gray * kRowNoise_gray;

/// Covariance of two rows over the right one's standard deviation, squared but for its sign: orders rows that are held
/// against the same left one as the correlation coefficient does.
double likeness(const std::uint8_t* left, const std::uint8_t* right) {
  constexpr int n = kernels::kRowColumns;
  const int left_sum = std::accumulate(left, left + n, 0), right_sum = std::accumulate(right, right + n, 0);
  const double covariance = n * std::inner_product(left, left + n, right, 0) - left_sum * right_sum;
  const double variance = n * std::inner_product(right, right + n, right, 0) - right_sum * right_sum;
  return covariance * std::abs(covariance) / (variance + kRowNoise);
}

kernels::Linear single(const Habitat::Linear& l) {
  return {static_cast<float>(l.constant), static_cast<float>(l.per_u), static_cast<float>(l.per_v)};
}

kernels::SpawnSearch spawn_search(const Habitat& habitat, const EvolveOptions& options) {
  const auto f = [](double value) { return static_cast<float>(value); };
  const auto& field = habitat.field();
  const auto& height = habitat.height();
  const double infinity_px = habitat.projection().disparity_offset_px();
  const double min_q = habitat.projection().disparity_at_depth(field.x_max_m) - infinity_px;
  const double max_q = habitat.projection().disparity_at_depth(field.x_min_m) - infinity_px;
  return {.left = habitat.pair().left,
          .infinity_px = f(infinity_px),
          .min_q = f(min_q),
          .span_q = f(max_q - min_q),
          .q_at_ratios = options.initial == InitialDistribution::ratios ? habitat.q_at_ratios().data() : nullptr,
          .min_m = f(field.z_min_m),
          .span_m = f(field.z_max_m - field.z_min_m),
          .v_per_height_q = f(1.0 / height.per_v),
          .v_per_q = f(-habitat.camera_above_road_m() / height.per_v),
          .v_constant = f(-height.constant / height.per_v),
          .v_per_u = f(-height.per_u / height.per_v),
          .x = single(habitat.x()),
          .y = single(habitat.y()),
          .x_min_m = f(field.x_min_m),
          .x_max_m = f(field.x_max_m),
          .y_min_m = f(field.y_min_m),
          .y_max_m = f(field.y_max_m),
          .min_contrast = static_cast<int>(std::ceil(options.informative_gray)),
          .max_draws = kMaxDraws,
          .seed = 0,
          .purpose = 0,
          .generation = 0};
}

void check_scouts(int scouts) {
  if (scouts < 0 || scouts > kernels::kMaxScouts)
    throw InputError("evolve options", "scouts",
                     fmt::format("found {}, expected 0..{}", scouts, int{kernels::kMaxScouts}));
}

}  // namespace

int row_contrast(const GrayView& left, const StereoPoint& point) {
  if (!(point.u_px > -0.5 && point.u_px < left.width_px - 0.5 && point.v_px > -0.5 &&
        point.v_px < left.height_px - 0.5))
    return 0;
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): above -0.5, as was asked
  const auto u = static_cast<int>(point.u_px + 0.5), v = static_cast<int>(point.v_px + 0.5);
  const std::uint8_t* row = left.row(v);
  const int first = std::max(std::min(u - kContrastWindow_px / 2, left.width_px - kContrastWindow_px), 0);
  const int end = std::min(first + kContrastWindow_px, left.width_px);
  const auto [darkest, brightest] = std::minmax_element(row + first, row + end);
  return *brightest - *darkest;
}

StereoPoint spawn(const Habitat& habitat, const EvolveOptions& options, FlyDraws draws) {
  StereoPoint fly;
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const auto words = draws.next();
    fly = draw_fly(habitat, options.initial, words);
    if (habitat.holds(fly) && row_contrast(habitat.left(), fly) >= options.informative_gray) break;
  }
  return fly;
}

void spawn(const Habitat& habitat, const EvolveOptions& options, const FlyRange& range, std::size_t begin,
           ImagePopulation& flies) {
  if (options.initial != InitialDistribution::space && habitat.left().width_px >= kernels::kMinWidth_px) {
    auto search = spawn_search(habitat, options);
    search.seed = range.seed;
    search.purpose = range.purpose;
    search.generation = range.generation;
    kernels::spawn_flies(search, range.first, range.count, flies.u_px.data() + begin, flies.v_px.data() + begin,
                         flies.disparity_px.data() + begin);
    return;
  }
  for (std::size_t k = 0; k < range.count; ++k) {
    const FlyDraws draws(range.seed, range.purpose, range.generation, range.first + static_cast<std::uint32_t>(k));
    flies.set(begin + k, spawn(habitat, options, draws));
  }
}

StereoPoint scout(const Habitat& habitat, int scouts, const StereoPoint& fly, FlyDraws draws) {
  check_scouts(scouts);
  constexpr int kReach_px = kernels::kRowColumns / 2;
  const auto& [left_image, right_image] = habitat.pair();
  const auto nearest = [](double coordinate_px) { return saturated<int>(std::floor(coordinate_px + 0.5)); };
  // Written so that a coordinate that is no number is outside.
  const bool is_inside =
      fly.u_px >= 0.0 && fly.u_px <= left_image.width_px && fly.v_px >= 0.0 && fly.v_px <= left_image.height_px;
  if (!is_inside) return fly;
  const auto fits = [&](int column) { return column >= 0 && column <= left_image.width_px - kernels::kRowColumns; };
  const int column = nearest(fly.u_px) - kReach_px, row = nearest(fly.v_px);
  // Vectors read some pixels behind a row, so there must be one below.
  if (!fits(column) || row + 1 >= left_image.height_px) return fly;
  const auto [least_q, most_q] = habitat.sight(fly.u_px, fly.v_px);
  if (!(least_q < most_q)) return fly;

  const double place = draws.next()[0] * 0x1p-32;
  StereoPoint best = fly;
  double best_likeness = -std::numeric_limits<double>::infinity();
  for (int step = 0; step < scouts; ++step) {
    const double q = least_q * std::pow(most_q / least_q, (step + place) / scouts);
    const double disparity_px = habitat.projection().disparity_offset_px() + q;
    const int right_column = nearest(fly.u_px - disparity_px - kReach_px);
    if (fly.u_px - disparity_px < kReach_px || !fits(right_column)) continue;
    const double found = likeness(left_image.row(row) + column, right_image.row(row) + right_column);
    if (found <= best_likeness) continue;
    best_likeness = found;
    best.disparity_px = disparity_px;
  }
  return best;
}

void scout(const Habitat& habitat, int scouts, const FlyRange& range, std::size_t begin, ImagePopulation& flies) {
  check_scouts(scouts);
  if (scouts == 0) return;
  const auto in_single = [](std::span<const Habitat::Linear> all) {
    kernels::LinearBounds bounds;
    for (const auto& bound : all) bounds.add(single(bound));
    return bounds;
  };
  const kernels::ScoutSearch search = {.left = habitat.pair().left,
                                       .right = habitat.pair().right,
                                       .infinity_px = static_cast<float>(habitat.projection().disparity_offset_px()),
                                       .farthest = in_single(habitat.least_q()),
                                       .nearest = in_single(habitat.most_q()),
                                       .scouts = scouts,
                                       .noise = static_cast<float>(kRowNoise),
                                       .seed = range.seed,
                                       .purpose = range.purpose,
                                       .generation = range.generation};
  kernels::scout_flies(search, range.first, range.count, flies.u_px.data() + begin, flies.v_px.data() + begin,
                       flies.disparity_px.data() + begin);
}

StereoPoint mutate(const Habitat& habitat, const MutationOptions& options, double scale, const StereoPoint& parent,
                   FlyDraws& draws) {
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const auto words = draws.next();
    const StereoPoint child{parent.u_px + scale * options.image_px * standard_normal(words[0]),
                            parent.v_px + scale * options.image_px * standard_normal(words[1]),
                            parent.disparity_px + scale * options.disparity_px * standard_normal(words[2])};
    if (habitat.holds(child)) return child;
  }
  return parent;
}

StereoPoint cross(const Habitat& habitat, const StereoPoint& mother, const StereoPoint& father, double share) {
  // A segment in space projects to a segment, run through at a speed that falls with the distance.
  const double infinity_px = habitat.projection().disparity_offset_px();
  const double mother_weight = (1.0 - share) * (father.disparity_px - infinity_px);
  const double father_weight = share * (mother.disparity_px - infinity_px);
  const double image_share = father_weight / (mother_weight + father_weight);
  if (!(image_share >= 0.0 && image_share <= 1.0)) return mother;  // a parent is nowhere
  return {std::lerp(mother.u_px, father.u_px, image_share), std::lerp(mother.v_px, father.v_px, image_share),
          std::lerp(mother.disparity_px, father.disparity_px, image_share)};
}

StereoPoint steer(const Habitat& habitat, std::span<const Obstacle> obstacles, FlyDraws& draws) {
  assert(!obstacles.empty());
  const auto words = draws.next();
  const auto& obstacle = obstacles[below(words[0], static_cast<std::uint32_t>(obstacles.size()))];
  const double stretch = 1.0 + kSteeringDepthSpread * standard_normal(words[1]);
  const double x_m = obstacle.x_m * stretch;
  const double y_m = (obstacle.y_m + 0.5 * obstacle.width_m * standard_normal(words[2])) * stretch;
  const double top_m = std::clamp(obstacle.height_m, habitat.field().z_min_m, habitat.field().z_max_m);
  return project(habitat, {x_m, y_m, habitat.road().z_m(x_m, y_m) + uniform(words[3], habitat.field().z_min_m, top_m)});
}

}  // namespace flies
