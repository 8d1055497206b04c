#include "flies/evolve/operators.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace flies {
namespace {

/// Draws that may miss the habitat before the operator settles for less; bounds the time of every child.
constexpr int kMaxDraws = 16;

/// Half the width of the default patch: contrast within it is what the fitness will see.
constexpr int kContrastReach_px = 6;

/// Spread of steered flies about the near face, as a share of the range: as uncertain as a good stereo range.
constexpr double kSteeringDepthSpread = 0.03;

bool in_image(const Habitat& habitat, const StereoPoint& p) {
  return p.u_px >= 0.0 && p.u_px <= habitat.left.width_px - 1 && p.v_px >= 0.0 && p.v_px <= habitat.left.height_px - 1;
}

/// A point of the field with uniform image column, disparity and height above the road.
Point3 draw_in_image(const Habitat& habitat, FlyRandom& random) {
  const auto& field = habitat.field;
  const double u_px = random.uniform(0.0, habitat.left.width_px - 1);
  const double height_m = random.uniform(field.z_min_m, field.z_max_m);
  const double disparity_px = random.uniform(habitat.projection.disparity_at_depth(field.x_max_m),
                                             habitat.projection.disparity_at_depth(field.x_min_m));
  // Any row serves to find the column's azimuth; the height is then set above the road.
  Point3 point = habitat.projection.triangulate({u_px, habitat.projection.cy_px(), disparity_px});
  point.z_m = habitat.road.z_m(point.x_m, point.y_m) + height_m;
  return point;
}

Point3 draw_in_space(const Habitat& habitat, FlyRandom& random) {
  const auto& field = habitat.field;
  Point3 point{random.uniform(field.x_min_m, field.x_max_m), random.uniform(field.y_min_m, field.y_max_m), 0.0};
  point.z_m = habitat.road.z_m(point.x_m, point.y_m) + random.uniform(field.z_min_m, field.z_max_m);
  return point;
}

}  // namespace

bool in_habitat(const Habitat& habitat, const Point3& point) {
  return in_field(habitat.field, habitat.road, point) && habitat.projection.depth_m(point) > 0.0 &&
         in_image(habitat, habitat.projection.project(point));
}

int row_contrast(const GrayView& left, const StereoPoint& point) {
  const int u = static_cast<int>(std::lround(point.u_px)), v = static_cast<int>(std::lround(point.v_px));
  if (u < 0 || u >= left.width_px || v < 0 || v >= left.height_px) return 0;
  const std::uint8_t* row = left.row(v);
  const auto [darkest, brightest] = std::minmax_element(row + std::max(u - kContrastReach_px, 0),
                                                        row + std::min(u + kContrastReach_px + 1, left.width_px));
  return *brightest - *darkest;
}

Point3 spawn(const Habitat& habitat, InitialDistribution distribution, double informative_gray, FlyRandom& random) {
  Point3 point;
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    point =
        distribution == InitialDistribution::image ? draw_in_image(habitat, random) : draw_in_space(habitat, random);
    if (in_habitat(habitat, point) && row_contrast(habitat.left, habitat.projection.project(point)) >= informative_gray)
      break;
  }
  return point;
}

std::vector<float> crowding(const Habitat& habitat, const Population& flies, int cell_px) {
  // One cell of margin on every side lets the neighbours of border cells be counted without a test.
  const int columns = habitat.left.width_px / cell_px + 3, rows = habitat.left.height_px / cell_px + 3;
  std::vector<std::uint32_t> counts(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::vector<std::ptrdiff_t> cell_of_fly(flies.size(), -1);
  for (std::size_t i = 0; i < flies.size(); ++i) {
    const Point3 point = flies.point(i);
    if (!(habitat.projection.depth_m(point) > 0.0)) continue;
    const auto image = habitat.projection.project(point);
    if (!in_image(habitat, image)) continue;
    const auto cell = (static_cast<std::ptrdiff_t>(image.v_px) / cell_px + 1) * columns +
                      static_cast<std::ptrdiff_t>(image.u_px) / cell_px + 1;
    cell_of_fly[i] = cell;
    auto* own = counts.data() + cell;
    own[0] += 2;
    own[-1] += 1;
    own[1] += 1;
    own[-columns] += 1;
    own[columns] += 1;
  }
  std::vector<float> result(flies.size(), 1.0F);
  for (std::size_t i = 0; i < flies.size(); ++i)
    if (cell_of_fly[i] >= 0) result[i] = static_cast<float>(counts[static_cast<std::size_t>(cell_of_fly[i])]) / 2.0F;
  return result;
}

std::vector<float> share_fitness(std::span<const float> fitness, std::span<const float> crowding, double strength) {
  assert(fitness.size() == crowding.size());
  std::vector<float> shared(fitness.begin(), fitness.end());
  if (strength == 0.0) return shared;
  for (std::size_t i = 0; i < shared.size(); ++i)
    shared[i] /= strength == 1.0 ? crowding[i] : std::pow(crowding[i], static_cast<float>(strength));
  return shared;
}

namespace {

/// What a fly looks at in one of the images.
struct Look {
  float u_px = 0.0F, v_px = 0.0F, disparity_px = 0.0F, fitness = 0.0F;
};

/// Marks every look that has a rival: the fittest look of its own or a neighbouring cell, if that is near enough, of
/// other disparity and `margin` times as fit. Cells are one reach wide, so nine of them cover the reach.
void mark_rivalled(std::span<const Look> looks, const Habitat& habitat, const UniquenessOptions& options,
                   std::vector<bool>& rivalled) {
  const int columns = static_cast<int>(habitat.left.width_px / options.reach_u_px) + 3;
  const int rows = static_cast<int>(habitat.left.height_px / options.reach_v_px) + 3;
  std::vector<Look> fittest(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  const auto cell_of = [&](const Look& look) -> std::ptrdiff_t {
    const double column = std::floor(look.u_px / options.reach_u_px) + 1,
                 row = std::floor(look.v_px / options.reach_v_px) + 1;
    if (!(look.fitness > 0.0F) || column < 1 || column > columns - 2 || row < 1 || row > rows - 2) return -1;
    return static_cast<std::ptrdiff_t>(row) * columns + static_cast<std::ptrdiff_t>(column);
  };
  for (const auto& look : looks)
    if (const auto cell = cell_of(look); cell >= 0 && look.fitness > fittest[static_cast<std::size_t>(cell)].fitness)
      fittest[static_cast<std::size_t>(cell)] = look;
  const auto rivals = [&](const Look& look, const Look& other) {
    return other.fitness > options.margin * look.fitness && std::abs(other.u_px - look.u_px) <= options.reach_u_px &&
           std::abs(other.v_px - look.v_px) <= options.reach_v_px &&
           std::abs(other.disparity_px - look.disparity_px) > options.disparity_px;
  };
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const auto cell = cell_of(looks[i]);
    if (cell < 0) continue;
    for (const std::ptrdiff_t row : {-columns, 0, columns})
      for (const std::ptrdiff_t column : {-1, 0, 1})
        if (rivals(looks[i], fittest[static_cast<std::size_t>(cell + row + column)])) rivalled[i] = true;
  }
}

}  // namespace

std::vector<bool> find_rivalled(const Habitat& habitat, const Population& flies, const UniquenessOptions& options) {
  std::vector<Look> left(flies.size()), right(flies.size());
  for (std::size_t i = 0; i < flies.size(); ++i) {
    if (!(flies.fitness[i] > 0.0F)) continue;
    const auto image = habitat.projection.project(flies.point(i));
    left[i] = {static_cast<float>(image.u_px), static_cast<float>(image.v_px), static_cast<float>(image.disparity_px),
               flies.fitness[i]};
    right[i] = left[i];
    right[i].u_px -= left[i].disparity_px;
  }
  std::vector<bool> rivalled(flies.size());
  mark_rivalled(left, habitat, options, rivalled);
  mark_rivalled(right, habitat, options, rivalled);
  return rivalled;
}

std::vector<std::uint32_t> select_fittest(std::span<const float> shared_fitness, std::size_t count) {
  count = std::min(count, shared_fitness.size());
  std::vector<std::uint32_t> indices(shared_fitness.size());
  std::iota(indices.begin(), indices.end(), 0U);
  const auto fitter = [&](std::uint32_t a, std::uint32_t b) {
    return shared_fitness[a] != shared_fitness[b] ? shared_fitness[a] > shared_fitness[b] : a < b;
  };
  const auto end = indices.begin() + static_cast<std::ptrdiff_t>(count);
  if (end != indices.end()) std::nth_element(indices.begin(), end, indices.end(), fitter);
  indices.erase(end, indices.end());
  std::sort(indices.begin(), indices.end());
  return indices;
}

Point3 mutate(const Habitat& habitat, const MutationOptions& options, double scale, const Point3& parent,
              FlyRandom& random) {
  const auto image = habitat.projection.project(parent);
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const StereoPoint moved{image.u_px + scale * options.image_px * random.normal(),
                            image.v_px + scale * options.image_px * random.normal(),
                            image.disparity_px + scale * options.disparity_px * random.normal()};
    const Point3 child = habitat.projection.triangulate(moved);
    if (in_habitat(habitat, child)) return child;
  }
  return parent;
}

Point3 cross(const Point3& mother, const Point3& father, FlyRandom& random) {
  const double share = random.uniform();
  return {std::lerp(mother.x_m, father.x_m, share), std::lerp(mother.y_m, father.y_m, share),
          std::lerp(mother.z_m, father.z_m, share)};
}

Point3 steer(const Habitat& habitat, std::span<const Obstacle> obstacles, FlyRandom& random) {
  assert(!obstacles.empty());
  const auto& obstacle = obstacles[random.below(static_cast<std::uint32_t>(obstacles.size()))];
  const double stretch = 1.0 + kSteeringDepthSpread * random.normal();
  const double y_m = obstacle.y_m + 0.5 * obstacle.width_m * random.normal();
  Point3 point{obstacle.x_m * stretch, y_m * stretch, 0.0};
  const double top_m = std::clamp(obstacle.height_m, habitat.field.z_min_m, habitat.field.z_max_m);
  point.z_m = habitat.road.z_m(point.x_m, point.y_m) + random.uniform(habitat.field.z_min_m, top_m);
  return point;
}

}  // namespace flies
