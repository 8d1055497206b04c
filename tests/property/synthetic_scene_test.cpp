// What must hold on scenes of known depth, whatever the scene: the fitness tells surfaces, obstacles stand where they
// are, and an empty road is empty.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "flies/evolve/operators.hpp"
#include "flies/fitness/fitness.hpp"
#include "flies/pipeline/detector.hpp"
#include "flies/synth/render.hpp"

namespace flies {
namespace {

/// Row contrast from which a place counts as textured: several times the sensor noise of 1.5 grey levels.
constexpr int kTextured_gray = 20;

/// A neighbourhood lies on one surface when its disparities agree to this.
constexpr double kOneSurface_px = 1.0;

RenderedPair render(SceneKind kind, std::uint64_t seed, double range_m = 6.0) {
  SceneOptions options;
  options.kind = kind;
  options.seed = seed;
  options.people_min_range_m = range_m;
  return render_pair(options);
}

StereoCamera camera() { return synthetic_camera({}); }

/// Places on a grid of the left image with texture and a single surface above the road, inside both images.
std::vector<StereoPoint> textured_places(const RenderedPair& scene, const FitnessOptions& fitness) {
  const auto left = scene.left_gray.view();
  const Projection projection(camera());
  const auto disparity = [&](int u, int v) {
    return static_cast<double>(scene.pixels.disparity_px[scene.pixels.index(u, v)]);
  };
  std::vector<StereoPoint> places;
  for (int v = 20; v < left.height_px - 20; v += 3)
    for (int u = 20; u < left.width_px - 20; u += 3) {
      const double d = disparity(u, v);
      if (!(d > projection.disparity_at_depth(45.0)) || projection.triangulate({1.0 * u, 1.0 * v, d}).z_m < 0.4)
        continue;
      if (row_contrast(left, {1.0 * u, 1.0 * v, d}) < kTextured_gray) continue;
      bool one_surface = true;
      for (const int i : {-fitness.half_width_px, 0, fitness.half_width_px})
        for (const int j : {-fitness.half_height_px, 0, fitness.half_height_px})
          one_surface = one_surface && std::abs(disparity(u + i, v + j) - d) < kOneSurface_px;
      if (one_surface && u - d * 1.2 > 20) places.push_back({1.0 * u, 1.0 * v, d});
    }
  return places;
}

TEST(CovarianceFitness, IsHigherOnTheSurfaceThanTenPercentOffInRange) {
  FitnessOptions fitness = preset_options(Preset::paper).fitness;
  ASSERT_EQ(fitness.function, FitnessFunction::covariance);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto scene = render(SceneKind::street, seed);
    const auto places = textured_places(scene, fitness);
    ASSERT_GT(places.size(), 1000U);
    std::size_t compared = 0, right = 0;
    for (const auto& place : places)
      for (const double range : {0.9, 1.1}) {
        const StereoPoint moved{place.u_px, place.v_px, place.disparity_px / range};
        ++compared;
        right += score_point(scene.gray_pair(), fitness, place) > score_point(scene.gray_pair(), fitness, moved);
      }
    const double share = static_cast<double>(right) / static_cast<double>(compared);
    RecordProperty("seed_" + std::to_string(seed), std::to_string(share));
    std::printf("seed %llu: on the surface scores higher in %.1f %% of %zu comparisons\n",
                static_cast<unsigned long long>(seed), 100.0 * share, compared);
    EXPECT_GE(share, 0.9);
  }
}

/// Median horizontal distance of the visible surface of the scene's only object.
double visible_range_m(const RenderedPair& scene, const TruthObject& object) {
  const Projection projection(camera());
  std::vector<double> ranges_m;
  const auto left = scene.left_gray.view();
  for (int v = 0; v < left.height_px; ++v)
    for (int u = 0; u < left.width_px; ++u) {
      const auto i = scene.pixels.index(u, v);
      if (scene.pixels.object[i] != static_cast<int>(object.scene_index)) continue;
      const Point3 p = projection.triangulate({1.0 * u, 1.0 * v, scene.pixels.disparity_px[i]});
      ranges_m.push_back(std::hypot(p.x_m, p.y_m));
    }
  std::nth_element(ranges_m.begin(), ranges_m.begin() + static_cast<std::ptrdiff_t>(ranges_m.size() / 2),
                   ranges_m.end());
  return ranges_m[ranges_m.size() / 2];
}

struct PlacedPerson {
  double range_m;
  std::uint64_t seed;
};
class Person : public testing::TestWithParam<PlacedPerson> {};

TEST_P(Person, IsTheOnlyObstacleWithItsRangeWithinThreePercent) {
  const auto scene = render(SceneKind::pedestrian, GetParam().seed, GetParam().range_m);
  ASSERT_EQ(scene.objects.size(), 1U);
  const auto& truth = scene.objects[0];
  const auto found = Detector(camera()).process(scene.gray_pair());
  ASSERT_EQ(found.obstacles.size(), 1U);
  const auto& obstacle = found.obstacles[0];
  const double range_m = visible_range_m(scene, truth);
  std::printf("person at %.2f m, found at %.2f m (%+.1f %%), height %.2f m, found %.2f m\n", range_m, obstacle.range_m,
              100.0 * (obstacle.range_m / range_m - 1.0), truth.height_m, obstacle.height_m);
  EXPECT_NEAR(obstacle.range_m, range_m, 0.03 * range_m);
  EXPECT_NEAR(obstacle.y_m, truth.y_m, 0.3);
}

INSTANTIATE_TEST_SUITE_P(RangesAndSeeds, Person,
                         testing::Values(PlacedPerson{7, 1}, PlacedPerson{7, 2}, PlacedPerson{12, 3},
                                         PlacedPerson{12, 4}, PlacedPerson{18, 5}, PlacedPerson{18, 6},
                                         PlacedPerson{25, 7}, PlacedPerson{25, 8}));

TEST(Wall, IsFoundWithItsRangeWithinThreePercent) {
  for (const double range_m : {10.0, 20.0}) {
    const auto scene = render(SceneKind::wall, 1, range_m);
    ASSERT_EQ(scene.objects.size(), 1U);
    const auto found = Detector(camera()).process(scene.gray_pair());
    ASSERT_FALSE(found.obstacles.empty());
    // The wall is flat and faces the camera: its range along x is the same everywhere.
    const double near_m = scene.objects[0].near_range_m;
    for (const auto& obstacle : found.obstacles) EXPECT_NEAR(obstacle.x_m, near_m, 0.03 * near_m);
  }
}

TEST(EmptyRoad, HasNoObstaclesAndNoPedestrians) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const auto found = Detector(camera()).process(render(SceneKind::empty_road, seed).gray_pair());
    EXPECT_TRUE(found.obstacles.empty()) << "seed " << seed << ": " << found.obstacles.size() << " obstacles, first at "
                                         << found.obstacles[0].x_m << ", " << found.obstacles[0].y_m;
    EXPECT_TRUE(found.pedestrians.empty()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace flies
