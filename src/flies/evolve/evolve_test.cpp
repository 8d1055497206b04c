#include "flies/evolve/evolve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "flies/core/count_allocations.hpp"
#include "flies/core/error.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

constexpr int kWidth_px = 320, kHeight_px = 160;
constexpr double kWall_m = 12.5;  ///< disparity 500 * 0.4 / 12.5 = 16 px

StereoCamera camera() {
  return {.fx_px = 500,
          .fy_px = 500,
          .cx_px = 160,
          .cx_right_px = 160,
          .cy_px = 80,
          .baseline_m = 0.4,
          .width_px = kWidth_px,
          .height_px = kHeight_px,
          .mount = {.height_m = 1.2}};
}

/// A wall of noise at `kWall_m` that fills both images.
struct Wall {
  std::vector<std::uint8_t> left, right;

  Wall() : left(kWidth_px * kHeight_px), right(kWidth_px * kHeight_px) {
    for (int v = 0; v < kHeight_px; ++v)
      for (int u = 0; u < kWidth_px; ++u) {
        const auto gray = [&](int column) {
          return static_cast<std::uint8_t>(
              FlyRandom(2, 0, static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(column)).below(256));
        };
        left[static_cast<std::size_t>(v * kWidth_px + u)] = gray(u);
        right[static_cast<std::size_t>(v * kWidth_px + u)] = gray(u + 16);
      }
  }
  RectifiedPair pair() const {
    return {{left.data(), kWidth_px, kHeight_px, kWidth_px}, {right.data(), kWidth_px, kHeight_px, kWidth_px}};
  }
};

EvolveOptions small_options() {
  EvolveOptions options;
  options.flies = 600;
  return options;
}

EvolveResult run(const Wall& wall, const EvolveOptions& options, const RandomSource& random = {},
                 std::span<const Obstacle> steer_towards = {}) {
  return evolve(wall.pair(), Projection(camera()), {}, {}, {}, options, random, steer_towards);
}

/// Share of the total fitness held by flies within 2 % of the wall.
double share_on_wall(const EvolveResult& result) {
  double on = 0.0, all = 0.0;
  for (std::size_t i = 0; i < result.flies.size(); ++i) {
    all += result.flies.fitness[i];
    if (std::abs(result.flies.x_m[i] - kWall_m) < 0.02 * kWall_m) on += result.flies.fitness[i];
  }
  return on / all;
}

TEST(Evolve, GathersFliesOnTheSurface) {
  const Wall wall;
  auto options = small_options();
  options.scouts = 0;  // evolution alone
  options.generations = 0;
  options.refine.share = 0.0;
  const auto spread = run(wall, options);
  options.generations = 4;
  const auto evolved = run(wall, options);
  const auto total = [](const EvolveResult& r) {
    return std::accumulate(r.flies.fitness.begin(), r.flies.fitness.end(), 0.0);
  };
  EXPECT_GT(total(evolved), 5.0 * total(spread));
  // Newcomers of the last generation, half of its children, are still spread all over.
  EXPECT_GT(share_on_wall(evolved), 0.8);
}

TEST(Evolve, RefinesTheRangeOfTheFittest) {
  const Wall wall;
  auto options = small_options();
  options.generations = 2;
  const auto spread_m = [](const EvolveResult& r) {
    double sum = 0.0, weight = 0.0;
    for (std::size_t i = 0; i < r.flies.size(); ++i) {
      sum += r.flies.fitness[i] * std::pow(r.flies.x_m[i] - kWall_m, 2);
      weight += r.flies.fitness[i];
    }
    return std::sqrt(sum / weight);
  };
  options.refine.share = 0.0;
  const double before_m = spread_m(run(wall, options));
  options.refine.share = 1.0;
  EXPECT_LT(spread_m(run(wall, options)), before_m);
}

TEST(Evolve, KeepsThePopulationSizeAndCountsItsEvaluations) {
  auto options = small_options();
  options.generations = 3;
  options.keep_share = 0.25;
  options.refine.share = 0.5;
  const auto result = run(Wall(), options);
  EXPECT_EQ(result.flies.size(), 600U);
  EXPECT_EQ(result.evaluations, 600U + 3U * 450U + 2U * 300U);
}

TEST(Evolve, IsAFunctionOfSeedAndFrame) {
  const Wall wall;
  const auto options = small_options();
  const auto x_of = [&](const RandomSource& random) { return run(wall, options, random).flies.x_m; };
  const auto reference = x_of({1, 0});
  EXPECT_EQ(x_of({1, 0}), reference);
  EXPECT_NE(x_of({2, 0}), reference);
  EXPECT_NE(x_of({1, 1}), reference);
}

TEST(Evolve, DoesNotDependOnTheNumberOfThreads) {
  const Wall wall;
  const auto with_threads = [&](int threads) {
    return tbb::task_arena(threads).execute([&] { return run(wall, small_options()); });
  };
  const auto one = with_threads(1), four = with_threads(4);
  EXPECT_EQ(one.flies.x_m, four.flies.x_m);
  EXPECT_EQ(one.flies.z_m, four.flies.z_m);
  EXPECT_EQ(one.flies.fitness, four.flies.fitness);
}

TEST(Evolver, GivesTheSameResultsAsTheFunctionPairAfterPair) {
  const Wall wall;
  Evolver evolver;
  for (std::uint32_t frame = 0; frame < 3; ++frame) {
    const auto expected = run(wall, small_options(), {1, frame});
    const auto& found = evolver.evolve(wall.pair(), Projection(camera()), {}, {}, {}, small_options(), {1, frame});
    EXPECT_EQ(found.flies.x_m, expected.flies.x_m);
    EXPECT_EQ(found.flies.fitness, expected.flies.fitness);
    EXPECT_EQ(found.evaluations, expected.evaluations);
  }
}

TEST(Evolver, AllocatesNothingOnceItHasSeenAPair) {
  const Wall wall;
  const Projection projection(camera());
  Evolver evolver;
  tbb::task_arena(1).execute([&] {
    evolver.evolve(wall.pair(), projection, {}, {}, {}, small_options(), {1, 0});
    const std::size_t before = testing::allocations;
    evolver.evolve(wall.pair(), projection, {}, {}, {}, small_options(), {1, 1});
    EXPECT_EQ(testing::allocations, before);
  });
}

TEST(Evolver, GivesTheFliesInTheVehicleFrameAndInTheImage) {
  const auto result = run(Wall(), small_options());
  const Projection projection(camera());
  ASSERT_EQ(result.flies.size(), 600U);
  ASSERT_EQ(result.in_image.size(), 600U);
  for (std::size_t i = 0; i < result.flies.size(); ++i) {
    const auto image = projection.project(result.flies.point(i));
    // Coordinates are kept in single precision.
    EXPECT_NEAR(image.u_px, result.in_image.u_px[i], 1e-3);
    EXPECT_NEAR(image.v_px, result.in_image.v_px[i], 1e-3);
    EXPECT_NEAR(image.disparity_px, result.in_image.disparity_px[i], 1e-3);
    EXPECT_EQ(result.flies.fitness[i], result.in_image.fitness[i]);
  }
}

TEST(Evolve, SteersChildrenTowardsTheObstaclesItIsGiven) {
  auto options = small_options();
  options.generations = 0;
  options.immigration_share = 0.25;
  options.steering_share = 0.5;
  const std::vector<Obstacle> obstacles{
      {.x_m = 30, .y_m = 2, .range_m = 30, .width_m = 0.5, .height_m = 1.8, .box = {}}};
  const auto near_obstacle = [](const EvolveResult& r) {
    int count = 0;
    for (std::size_t i = 0; i < r.flies.size(); ++i)
      count += std::abs(r.flies.x_m[i] - 30) < 3 && std::abs(r.flies.y_m[i] - 2) < 1;
    return count;
  };
  EXPECT_GT(near_obstacle(run(Wall(), options, {}, obstacles)), 150);
  EXPECT_LT(near_obstacle(run(Wall(), options, {})), 60);
}

TEST(Evolve, TakesPopulationsThatKeepNoneOrAll) {
  const Wall wall;
  for (const double keep : {0.0, 1.0}) {
    auto options = small_options();
    options.keep_share = keep;
    EXPECT_EQ(run(wall, options).flies.size(), 600U);
  }
}

TEST(Evolve, TakesAnImageOfOnePixel) {
  const std::uint8_t pixel = 9;
  auto tiny = camera();
  tiny.width_px = tiny.height_px = 1;
  const auto result = evolve({{&pixel, 1, 1, 1}, {&pixel, 1, 1, 1}}, Projection(tiny), {}, {}, {}, small_options(), {});
  ASSERT_EQ(result.flies.fitness.size(), 600U);
  for (const float fitness : result.flies.fitness) EXPECT_EQ(fitness, 0.0F);
}

TEST(CheckEvolveOptions, RefusesSharesAboveOne) {
  EvolveOptions options;
  options.crossover_share = 0.5;
  options.immigration_share = 0.6;
  EXPECT_THROW(check_evolve_options(options, "options"), InputError);
}

TEST(Evolve, KeepsFliesFiniteForCamerasOfAnyScale) {
  const Wall wall;
  for (const double focal_px : {1e-3, 1e9})
    for (const double baseline_m : {1e-6, 1e6})
      for (const double right_px : {160.0, -1e5})
        for (const auto initial :
             {InitialDistribution::ratios, InitialDistribution::image, InitialDistribution::space}) {
          auto absurd = camera();
          absurd.fx_px = absurd.fy_px = focal_px;
          absurd.baseline_m = baseline_m;
          absurd.cx_right_px = right_px;
          absurd.mount.pitch_rad = -0.7;
          auto options = small_options();
          options.initial = initial;
          options.generations = 3;
          const auto flies = evolve(wall.pair(), Projection(absurd), {}, {}, {}, options, {}).flies;
          ASSERT_EQ(flies.size(), 600U);
          for (std::size_t i = 0; i < flies.size(); ++i) {
            const auto [point, fitness] = flies.fly(i);
            ASSERT_TRUE(std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m)) << focal_px;
            ASSERT_TRUE(std::isfinite(fitness) && fitness >= 0.0F) << focal_px;
          }
        }
}

}  // namespace
}  // namespace flies
