#include "flies/evolve/operators.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace flies {
namespace {

/// Draws that may miss the habitat before the operator settles for less; bounds the time of every child.
constexpr int kMaxDraws = 16;

/// Half the width of the default patch: contrast within it is what the fitness will see.
constexpr int kContrastReach_px = 6;

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

StereoPoint project(const Habitat& habitat, const Point3& point) {
  return habitat.projection().depth_m(point) > 0.0 ? habitat.projection().project(point) : kNowhere;
}

StereoPoint draw_in_space(const Habitat& habitat, const RandomWords& words) {
  const auto& field = habitat.field();
  const double x_m = uniform(words[0], field.x_min_m, field.x_max_m);
  const double y_m = uniform(words[1], field.y_min_m, field.y_max_m);
  return project(habitat, {x_m, y_m, habitat.road().z_m(x_m, y_m) + uniform(words[2], field.z_min_m, field.z_max_m)});
}

}  // namespace

int row_contrast(const GrayView& left, const StereoPoint& point) {
  if (!(point.u_px > -0.5 && point.u_px < left.width_px - 0.5 && point.v_px > -0.5 &&
        point.v_px < left.height_px - 0.5))
    return 0;
  const auto u = static_cast<int>(point.u_px + 0.5), v = static_cast<int>(point.v_px + 0.5);
  const std::uint8_t* row = left.row(v);
  const int end = std::min(u + kContrastReach_px + 1, left.width_px);
  std::uint8_t darkest = row[u], brightest = row[u];
  for (int i = std::max(u - kContrastReach_px, 0); i < end; ++i) {
    darkest = std::min(darkest, row[i]);
    brightest = std::max(brightest, row[i]);
  }
  return brightest - darkest;
}

StereoPoint spawn(const Habitat& habitat, InitialDistribution distribution, double informative_gray, FlyDraws& draws) {
  StereoPoint fly;
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const auto words = draws.next();
    fly = distribution == InitialDistribution::image ? draw_in_image(habitat, words) : draw_in_space(habitat, words);
    if (habitat.holds(fly) && row_contrast(habitat.left(), fly) >= informative_gray) break;
  }
  return fly;
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
