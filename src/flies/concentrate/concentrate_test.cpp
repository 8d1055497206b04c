#include "flies/concentrate/concentrate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <vector>

#include "flies/core/count_allocations.hpp"
#include "flies/core/error.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

StereoCamera camera() {
  return {.fx_px = 700,
          .fy_px = 700,
          .cx_px = 600,
          .cx_right_px = 600,
          .cy_px = 180,
          .baseline_m = 0.54,
          .width_px = 1200,
          .height_px = 370,
          .mount = {.height_m = 1.6}};
}
Projection projection() { return Projection(camera()); }

/// Adds `count` flies on an upright board facing the camera: centred at (x, y), with a little noise in depth.
void add_board(Population& flies, double x_m, double y_m, double width_m, double height_m, int count,
               float fitness = 1.0F) {
  const auto seed = static_cast<std::uint32_t>(std::lround(1000.0 * std::hypot(x_m, y_m)));
  for (int i = 0; i < count; ++i) {
    FlyRandom random(4, seed, 0, static_cast<std::uint32_t>(i));
    flies.push_back({x_m * (1.0 + 0.005 * random.normal()), y_m + width_m * (random.uniform() - 0.5),
                     random.uniform(0.2, height_m)},
                    fitness);
  }
}

/// Weak flies all over the field, as immigration leaves them.
void add_background(Population& flies, int count) {
  for (int i = 0; i < count; ++i) {
    FlyRandom random(5, 0, 0, static_cast<std::uint32_t>(i));
    const double x = random.uniform(5, 44);
    flies.push_back({x, x * random.uniform(-0.6, 0.6), random.uniform(0.2, 2.3)}, 0.001F);
  }
}

ConcentrateResult run(const Population& flies, const ConcentrateOptions& options = {}) {
  return concentrate(flies, projection(), {}, {}, options);
}

TEST(SampleHistograms, PutsTheSampleInTheFullestInterval) {
  Population flies;
  flies.push_back({10.2, 0.05, 1}, 1.0F);
  flies.push_back({10.4, 0.05, 1}, 1.0F);
  flies.push_back({20.2, 0.1, 1}, 1.5F);
  flies.push_back({30.0, 0.1, 1}, 0.0F);
  ConcentrateOptions options;
  options.samples = 1;
  const auto [axis, views] = sample_histograms(flies, {}, options);
  EXPECT_EQ(axis.bins, static_cast<int>((45.0 - 4.0) / 0.5));
  int sampled = 0;
  for (const auto& view : views) {
    if (view.samples.empty()) continue;
    ++sampled;
    ASSERT_EQ(view.samples.size(), 1U);
    EXPECT_DOUBLE_EQ(view.samples[0].x_m, 10.25);  // 10.0..10.5
    const double azimuth_rad = std::atan2(view.samples[0].y_m, view.samples[0].x_m);
    EXPECT_NEAR(azimuth_rad, 0.5 * (view.min_azimuth_rad + view.max_azimuth_rad), 1e-12);
    EXPECT_DOUBLE_EQ(view.votes[12], 2.0);
    EXPECT_DOUBLE_EQ(view.votes[32], 1.5);
  }
  EXPECT_EQ(sampled, 1);
}

TEST(SampleHistograms, GivesSeveralLocalMaximaWhenAsked) {
  Population flies;
  flies.push_back({10.2, 0.05, 1}, 2.0F);
  flies.push_back({10.7, 0.05, 1}, 1.9F);  // the shoulder of the first peak
  flies.push_back({20.2, 0.1, 1}, 1.0F);
  ConcentrateOptions options;
  options.samples = 3;
  int sampled = 0;
  for (const auto& view : sample_histograms(flies, {}, options).view_angles) {
    if (view.samples.empty()) continue;
    ++sampled;
    ASSERT_EQ(view.samples.size(), 2U);
    EXPECT_DOUBLE_EQ(view.samples[0].x_m, 10.25);
    EXPECT_DOUBLE_EQ(view.samples[1].x_m, 20.25);
  }
  EXPECT_EQ(sampled, 1);
}

TEST(DropFlies, ProjectsTheFootOnTheRoad) {
  Population flies;
  flies.push_back({14.0, 2.0, 1.3}, 0.7F);
  const RoadPlane road{.slope = 0.01};
  const auto dropped = drop_flies(flies, projection(), road);
  const auto foot = projection().project({14.0, 2.0, 0.14});
  ASSERT_EQ(dropped.size(), 1U);
  EXPECT_NEAR(dropped[0].pixel.u_px, foot.u_px, 1e-5);
  EXPECT_NEAR(dropped[0].pixel.v_px, foot.v_px, 1e-5);
  EXPECT_FLOAT_EQ(static_cast<float>(dropped[0].fitness), 0.7F);
}

TEST(ShiftMeans, MovesByTheEquationOfOneStep) {
  const std::vector<DroppedFly> flies{{{100, 50}, 2.0}, {{104, 50}, 1.0}, {{100, 58}, 1.0}};
  ConcentrateOptions options;
  options.bandwidth_px = 6.0;
  options.iterations = 1;
  const auto shifted = shift_means({{101, 51}}, flies, options);
  double total = 0, u = 0, v = 0;
  for (const auto& fly : flies) {
    const double w =
        fly.fitness * std::exp(-(std::pow(fly.pixel.u_px - 101, 2) + std::pow(fly.pixel.v_px - 51, 2)) / 72.0);
    total += w;
    u += w * fly.pixel.u_px;
    v += w * fly.pixel.v_px;
  }
  ASSERT_EQ(shifted.size(), 1U);
  EXPECT_EQ(shifted[0].start.u_px, 101);
  EXPECT_NEAR(shifted[0].end.u_px, u / total, 1e-12);
  EXPECT_NEAR(shifted[0].end.v_px, v / total, 1e-12);
}

TEST(ShiftMeans, EndsAtTheModeAndStaysPutFarFromAnyFly) {
  std::vector<DroppedFly> flies;
  for (int i = -3; i <= 3; ++i) flies.push_back({{200.0 + i, 80}, 1.0});
  ConcentrateOptions options;
  options.iterations = 30;
  const auto shifted = shift_means({{205, 84}, {500, 10}}, flies, options);
  EXPECT_NEAR(shifted[0].end.u_px, 200.0, 0.1);
  EXPECT_NEAR(shifted[0].end.v_px, 80.0, 0.1);
  EXPECT_EQ(shifted[1].end.u_px, 500.0);
}

TEST(ShiftMeans, IgnoresFliesWithoutFitness) {
  const std::vector<DroppedFly> flies{{{100, 50}, 1.0}, {{102, 50}, 0.0}};
  EXPECT_EQ(shift_means({{101, 50}}, flies, {})[0].end.u_px, 100.0);
}

TEST(ClusterPoints, ChainsPointsWithinTheRadius) {
  const auto centres = cluster_points({{0, 0}, {5, 0}, {10, 0}, {30, 0}}, 5.0);
  ASSERT_EQ(centres.size(), 2U);
  EXPECT_DOUBLE_EQ(centres[0].u_px, 5.0);
  EXPECT_DOUBLE_EQ(centres[1].u_px, 30.0);
  EXPECT_TRUE(cluster_points({}, 5.0).empty());
}

TEST(ClusterPoints, RefusesARadiusThatIsNotPositiveAndFinite) {
  const std::vector<PixelPoint> points(2);
  for (const double radius_px : {0.0, -1.0, HUGE_VAL, std::nan("")})
    EXPECT_THAT([&] { cluster_points(points, radius_px); }, ThrowsMessage<InputError>(HasSubstr("radius_px: found")));
}

TEST(FitnessDensity, IsTheMeanOfTheWeightedKernels) {
  const std::vector<DroppedFly> flies{{{100, 50}, 2.0}, {{106, 50}, 1.0}, {{900, 50}, 0.0}};
  EXPECT_NEAR(fitness_density({{100, 50}}, flies, 6.0)[0], (2.0 + std::exp(-0.5)) / 3.0, 1e-12);
  EXPECT_EQ(fitness_density({{500, 50}}, flies, 6.0)[0], 0.0);
}

TEST(FitnessDensity, RefusesABandwidthThatIsNotPositiveAndFinite) {
  const std::vector<PixelPoint> points(2);
  for (const double bandwidth_px : {0.0, -1.0, HUGE_VAL, std::nan("")})
    EXPECT_THAT([&] { fitness_density(points, {}, bandwidth_px); },
                ThrowsMessage<InputError>(HasSubstr("bandwidth_px: found")));
}

TEST(Concentrate, FindsPositionAndSizeOfAPerson) {
  Population flies;
  add_board(flies, 12.0, -1.5, 0.5, 1.7, 200);
  add_background(flies, 800);
  const auto result = run(flies);
  ASSERT_EQ(result.obstacles.size(), 1U);
  const auto& o = result.obstacles[0];
  EXPECT_NEAR(o.x_m, 12.0, 0.02 * 12.0);
  EXPECT_NEAR(o.y_m, -1.5, 0.1);
  EXPECT_NEAR(o.range_m, std::hypot(o.x_m, o.y_m), 1e-9);
  // Edges are quantiles of 5 and 95 % of what the flies cover.
  EXPECT_NEAR(o.width_m, 0.45, 0.08);
  EXPECT_NEAR(o.height_m, 1.62, 0.1);
  EXPECT_GT(o.score, 0.0);
  const auto head = projection().project({o.x_m, o.y_m, o.height_m}), foot = projection().project({o.x_m, o.y_m, 0.0});
  EXPECT_NEAR(o.box.v_px, head.v_px, 1.0);
  EXPECT_NEAR(o.box.v_px + o.box.height_px, foot.v_px, 1.0);
  EXPECT_NEAR(o.box.u_px + 0.5 * o.box.width_px, foot.u_px, 1.5);
}

TEST(Concentrate, ReturnsEveryIntermediateResult) {
  Population flies;
  add_board(flies, 12.0, -1.5, 0.5, 1.7, 200);
  const auto result = run(flies);
  EXPECT_EQ(result.view_angles.size(), 90U);
  EXPECT_FALSE(result.shifted.empty());
  ASSERT_FALSE(result.candidates.empty());
  const bool some_kept =
      std::any_of(result.candidates.begin(), result.candidates.end(), [](auto& c) { return c.kept; });
  EXPECT_TRUE(some_kept);
  ASSERT_EQ(result.obstacle_of_fly.size(), flies.size());
  EXPECT_GT(std::count(result.obstacle_of_fly.begin(), result.obstacle_of_fly.end(), 0), 190);
  const auto& c = result.candidates[0];
  const auto image = projection().project({c.ground.x_m, c.ground.y_m, 0.0});
  EXPECT_NEAR(image.u_px, c.pixel.u_px, 1e-6);
  EXPECT_NEAR(image.v_px, c.pixel.v_px, 1e-6);
}

TEST(Concentrate, KeepsTwoPeopleApartWithAStreetBetweenThem) {
  Population flies;
  add_board(flies, 12.0, -0.6, 0.5, 1.7, 200);
  add_board(flies, 12.0, 0.6, 0.5, 1.7, 200);
  add_board(flies, 30.0, 0.0, 1.2, 2.2, 200);
  const auto result = run(flies);
  ASSERT_EQ(result.obstacles.size(), 3U);
  EXPECT_LT(result.obstacles[0].range_m, 12.3);
  EXPECT_LT(result.obstacles[1].range_m, 12.3);
  EXPECT_GT(result.obstacles[2].range_m, 28.0);
}

TEST(Concentrate, JoinsTheEdgesOfAPlainVanAndOfNothingElse) {
  Population flies;
  add_board(flies, 15.0, 0.8, 0.2, 1.9, 150);
  add_board(flies, 15.0, -0.2, 0.2, 1.9, 150);
  auto joined = run(flies);
  ASSERT_EQ(joined.obstacles.size(), 1U);
  EXPECT_NEAR(joined.obstacles[0].width_m, 1.2, 0.15);

  ConcentrateOptions apart;
  apart.assemble.merge = false;
  EXPECT_GE(run(flies, apart).obstacles.size(), 2U);

  ConcentrateOptions narrow;
  narrow.assemble.max_width_m = 0.8;
  EXPECT_EQ(run(flies, narrow).obstacles.size(), 2U);
}

TEST(Concentrate, JoinsASurfaceBeyondTheWidthOfAnObject) {
  Population flies;
  for (int k = 0; k < 5; ++k) add_board(flies, 15.0, 2.0 - k, 0.9, 1.9, 150);
  const auto result = run(flies);
  ASSERT_EQ(result.obstacles.size(), 1U);
  EXPECT_NEAR(result.obstacles[0].width_m, 4.7, 0.4);

  ConcentrateOptions narrow;
  narrow.assemble.max_surface_m = narrow.assemble.max_width_m;
  EXPECT_GE(run(flies, narrow).obstacles.size(), 2U);
}

TEST(Concentrate, SeesThroughTheGapBetweenObjectsAndNotThroughThatBetweenLegs) {
  const auto found = [](double gap_m) {
    Population flies;
    add_board(flies, 8.0, 0.5 * gap_m + 0.2, 0.4, 1.7, 200);
    add_board(flies, 8.0, -0.5 * gap_m - 0.2, 0.4, 1.7, 200);
    add_board(flies, 30.0, 0.0, 4.0, 2.2, 1500);
    const auto result = run(flies);
    return std::count_if(result.obstacles.begin(), result.obstacles.end(),
                         [](const Obstacle& o) { return o.range_m < 9.0; });
  };
  EXPECT_EQ(found(0.3), 1);
  EXPECT_EQ(found(0.9), 2);
}

TEST(Concentrate, ReportsTheNearFaceOrTheCandidate) {
  Population flies;
  for (int i = 0; i < 300; ++i) {
    FlyRandom random(6, 0, 0, static_cast<std::uint32_t>(i));
    flies.push_back({random.uniform(10.0, 11.0), 0.3 * random.uniform(-1, 1), random.uniform(0.2, 1.6)}, 1.0F);
  }
  EXPECT_NEAR(run(flies).obstacles.at(0).range_m, 10.1, 0.06);
  ConcentrateOptions options;
  options.assemble.position = ObstaclePosition::candidate;
  const auto result = run(flies, options);
  EXPECT_GT(result.obstacles.at(0).range_m, 10.3);
  EXPECT_EQ(result.obstacles[0].x_m, result.candidates.at(0).ground.x_m);
}

TEST(Concentrate, DropsWhatIsLowSmallOrWeak) {
  Population kerb;
  add_board(kerb, 20.0, 1.0, 0.8, 0.35, 200);
  EXPECT_TRUE(run(kerb).obstacles.empty()) << "lower than an obstacle and the reach of a patch";

  Population point;
  for (int i = 0; i < 50; ++i) point.push_back({8.0, 0.001 * i, 1.0 + 0.002 * i}, 1.0F);
  EXPECT_TRUE(run(point).obstacles.empty()) << "one false match";

  Population weak;
  add_board(weak, 12.0, 0.0, 0.5, 1.7, 5);
  add_background(weak, 5000);
  EXPECT_TRUE(run(weak).obstacles.empty()) << "hardly any support";
}

TEST(Concentrate, DiscardsCandidatesOfLowDensity) {
  Population flies;
  add_board(flies, 12.0, -3.0, 0.5, 1.7, 200, 1.0F);
  add_board(flies, 12.0, 3.0, 0.5, 1.7, 200, 0.05F);
  EXPECT_EQ(run(flies).obstacles.size(), 2U);
  ConcentrateOptions options;
  options.min_density_share = 0.2;
  EXPECT_EQ(run(flies, options).obstacles.size(), 1U);
}

TEST(Concentrate, MeasuresHeightFromTheRoad) {
  Population flies;
  add_board(flies, 12.0, 0.0, 0.5, 1.7, 200);
  for (auto& z : flies.z_m) z += 0.3F;
  const auto result = concentrate(flies, projection(), {.height_m = 0.3}, {}, {});
  ASSERT_EQ(result.obstacles.size(), 1U);
  EXPECT_NEAR(result.obstacles[0].height_m, 1.62, 0.1);
  EXPECT_NEAR(result.obstacles[0].ground_z_m, 0.3, 1e-9);
}

TEST(Concentrate, FindsNothingInNothing) {
  EXPECT_TRUE(run({}).obstacles.empty());
  Population dead;
  add_board(dead, 12.0, 0.0, 0.5, 1.7, 100, 0.0F);
  EXPECT_TRUE(run(dead).obstacles.empty());
  Population no_numbers;
  no_numbers.push_back({std::nan(""), 0, 1}, 1.0F);
  no_numbers.push_back({10, 0, std::nan("")}, 1.0F);
  EXPECT_TRUE(run(no_numbers).obstacles.empty());
}

TEST(Concentrate, SortsObstaclesByRange) {
  Population flies;
  add_board(flies, 25.0, -3.0, 0.8, 1.7, 200);
  add_board(flies, 9.0, 3.0, 0.8, 1.7, 200);
  add_board(flies, 17.0, 0.0, 0.8, 1.7, 200);
  const auto obstacles = run(flies).obstacles;
  ASSERT_EQ(obstacles.size(), 3U);
  EXPECT_LT(obstacles[0].range_m, obstacles[1].range_m);
  EXPECT_LT(obstacles[1].range_m, obstacles[2].range_m);
}

TEST(Concentrate, TakesViewAnglesBeyondARightAngle) {
  Population flies;
  add_board(flies, 12.0, 3.0, 0.8, 1.7, 200);
  ConcentrateOptions wide;
  wide.half_field_deg = 89.0;
  wide.view_angle_deg = 30.0;  // six of them end at 91 degrees
  EXPECT_EQ(run(flies, wide).obstacles.size(), 1U);
}

/// A street with more on it from pair to pair, and the same number of flies.
Population street(int pair) {
  constexpr int kFlies = 2000, kFliesABoard = 150;
  const int boards = 3 + pair;
  Population flies;
  for (int k = 0; k < boards; ++k)
    add_board(flies, 8.0 + 3 * k, (k % 3 - 1) * 3.0 + 0.3 * pair, 0.3 + 0.2 * k, 1.8, kFliesABoard);
  add_background(flies, kFlies - boards * kFliesABoard);
  return flies;
}

TEST(Concentrator, GivesTheSameForEveryPairAsAFreshOne) {
  Concentrator concentrator;
  for (int pair = 0; pair < 4; ++pair) {
    const auto flies = street(pair);
    const auto expected = run(flies);
    const auto& found = concentrator.concentrate(flies, projection(), {}, {}, {});
    ASSERT_GT(found.obstacles.size(), 2U);
    ASSERT_EQ(found.obstacles.size(), expected.obstacles.size());
    for (std::size_t i = 0; i < found.obstacles.size(); ++i)
      EXPECT_EQ(found.obstacles[i].range_m, expected.obstacles[i].range_m);
    EXPECT_EQ(found.obstacle_of_fly, expected.obstacle_of_fly);
    EXPECT_EQ(found.candidates.size(), expected.candidates.size());
    EXPECT_EQ(found.view_angles[40].votes, expected.view_angles[40].votes);
  }
}

TEST(Concentrator, AllocatesNothingOnceItHasSeenAPopulationOfTheSize) {
  std::vector<Population> pairs;
  for (int pair = 0; pair < 6; ++pair) pairs.push_back(street(pair));
  const auto camera = projection();
  Concentrator concentrator;
  concentrator.concentrate(pairs.front(), camera, {}, {}, {});
  // On one thread: another one's start allocates, but is not what is measured.
  const std::size_t before = testing::allocations;
  tbb::task_arena(1).execute([&] {
    for (std::size_t pair = 1; pair < pairs.size(); ++pair) concentrator.concentrate(pairs[pair], camera, {}, {}, {});
  });
  EXPECT_EQ(testing::allocations, before);
}

TEST(Concentrate, GivesBoxesToACameraThatLeans) {
  for (const double roll_rad : {-0.7, -0.2, 0.2, 0.7}) {
    for (const double pitch_rad : {-0.7, 0.0, 0.7}) {
      Population flies;
      add_board(flies, 12, -4, 1.0, 1.8, 300);
      add_board(flies, 14, 4, 0.2, 2.2, 300);
      auto leaning = camera();
      leaning.mount.roll_rad = roll_rad;
      leaning.mount.pitch_rad = pitch_rad;
      const auto found = concentrate(flies, Projection(leaning), {}, {}, {});
      ASSERT_FALSE(found.obstacles.empty()) << roll_rad;
      for (const auto& obstacle : found.obstacles) {
        const Point3 middle{obstacle.x_m, obstacle.y_m, 0.5 * obstacle.height_m};
        const auto seen = Projection(leaning).project(middle);
        const auto& box = obstacle.box;
        EXPECT_GT(box.width_px, 0.0) << roll_rad;
        EXPECT_GT(box.height_px, 0.0) << roll_rad;
        EXPECT_TRUE(seen.u_px > box.u_px && seen.u_px < box.u_px + box.width_px) << roll_rad;
        EXPECT_TRUE(seen.v_px > box.v_px && seen.v_px < box.v_px + box.height_px) << roll_rad;
      }
    }
  }
}

}  // namespace
}  // namespace flies
