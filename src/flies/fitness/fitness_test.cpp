#include "flies/fitness/fitness.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <limits>
#include <vector>

#include "flies/core/random.hpp"
#include "flies/fitness/reference.hpp"

namespace flies {
namespace {

/// Left and right image owning their pixels.
struct TestPair {
  int width_px, height_px;
  std::vector<std::uint8_t> left, right;

  TestPair(int width, int height)
      : width_px(width),
        height_px(height),
        left(static_cast<std::size_t>(width * height)),
        right(static_cast<std::size_t>(width * height)) {}
  RectifiedPair view() const {
    return {{left.data(), width_px, height_px, width_px}, {right.data(), width_px, height_px, width_px}};
  }
  std::uint8_t& at(std::vector<std::uint8_t>& image, int u, int v) const {
    return image[static_cast<std::size_t>(v * width_px + u)];
  }
};

/// Noise that is the same in both images but for a shift by `disparity_px` columns.
TestPair shifted_noise(int disparity_px, int width = 96, int height = 64) {
  TestPair pair(width, height);
  FlyRandom random(5, 0, 0, 0);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) pair.at(pair.left, u, v) = static_cast<std::uint8_t>(random.below(256));
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      pair.at(pair.right, u, v) = u + disparity_px < width ? pair.at(pair.left, u + disparity_px, v)
                                                           : static_cast<std::uint8_t>(random.below(256));
  return pair;
}

FitnessOptions with(FitnessFunction function, PatchSampling sampling = PatchSampling::nearest) {
  FitnessOptions options;
  options.function = function;
  options.sampling = sampling;
  options.row_step = 1;
  return options;
}

constexpr std::array kFunctions = {FitnessFunction::louchet, FitnessFunction::covariance, FitnessFunction::correlation};
constexpr std::array kSamplings = {PatchSampling::nearest, PatchSampling::subpixel};

/// `score_point` returns float; everything before the last rounding is exact or double.
constexpr double kFloatRounding = 2e-6;

/// Steps of the kernel's sub-pixel interpolation.
constexpr double kSubpixelStep = 1.0 / 16.0;

void expect_matches_reference(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point) {
  const double reference = reference_fitness(pair, options, point);
  EXPECT_NEAR(score_point(pair, options, point), reference, kFloatRounding * std::max(1e-3, reference))
      << enum_name(options.function) << ' ' << enum_name(options.sampling) << " patch " << options.half_width_px << 'x'
      << options.half_height_px << " at " << point.u_px << ',' << point.v_px << ',' << point.disparity_px;
}

TEST(ScorePoint, MatchesTheReferenceForEveryPatchSize) {
  const auto pair = shifted_noise(9);
  for (const auto function : kFunctions)
    for (const auto sampling : kSamplings)
      for (int half_u = 1; half_u <= 12; ++half_u)
        for (int half_v = 1; half_v <= 16; ++half_v) {
          auto options = with(function, sampling);
          options.half_width_px = half_u;
          options.half_height_px = half_v;
          options.row_step = 1 + (half_u + half_v) % 4;
          expect_matches_reference(pair.view(), options, {47.3, 31.8, 9.0 + 3 * kSubpixelStep});
          expect_matches_reference(pair.view(), options, {47.0, 31.0, 9.0});
        }
}

TEST(ScorePoint, MatchesTheReferenceUpToTheBorders) {
  const auto pair = shifted_noise(4, 40, 30);
  for (const auto function : kFunctions)
    for (const auto sampling : kSamplings)
      for (const int row_step : {1, 2, 16}) {
        auto options = with(function, sampling);
        options.row_step = row_step;
        for (int u = -2; u < 43; ++u)
          for (int v = -2; v < 33; ++v)
            expect_matches_reference(pair.view(), options,
                                     {static_cast<double>(u), static_cast<double>(v), 4.0 + 5 * kSubpixelStep});
      }
}

TEST(ScorePoint, MatchesTheReferenceOnSaturatedImages) {
  TestPair pair(96, 64);
  for (std::size_t i = 0; i < pair.left.size(); ++i) {
    pair.left[i] = i % 2 == 0 ? 255 : 0;
    pair.right[i] = i % 3 == 0 ? 0 : 255;
  }
  for (const auto function : kFunctions)
    for (const auto sampling : kSamplings)
      for (int half_u = 1; half_u <= 12; ++half_u) {
        auto options = with(function, sampling);
        options.half_width_px = half_u;
        options.half_height_px = 16;
        expect_matches_reference(pair.view(), options, {50, 30, 7.0 + kSubpixelStep});
      }
}

TEST(ScorePoint, FollowsEquation1OnAHandMadePatch) {
  // One column step of 10 grey levels: |gradient| = 5 at the edge's left column, G = sqrt(5).
  TestPair pair(32, 32);
  for (int v = 0; v < 32; ++v)
    for (int u = 0; u < 32; ++u) {
      pair.at(pair.left, u, v) = u > 16 ? 110 : 100;
      pair.at(pair.right, u, v) = u > 12 ? 112 : 100;  // 2 grey levels brighter right of the edge, disparity 4
    }
  auto options = with(FitnessFunction::louchet);
  options.half_width_px = 1;
  options.half_height_px = 1;
  options.louchet_constant = 3.0;
  // Of the 3 x 3 differences the right column is off by 2 grey levels: sum of squares 3 * 4.
  EXPECT_NEAR(score_point(pair.view(), options, {16, 16, 4}), std::sqrt(5.0) / (3.0 + 12.0), kFloatRounding);
}

TEST(ScorePoint, FollowsEquation2OnAHandMadePatch) {
  TestPair pair(32, 32);
  for (int v = 0; v < 32; ++v)
    for (int u = 0; u < 32; ++u) {
      pair.at(pair.left, u, v) = u > 16 ? 110 : 100;
      pair.at(pair.right, u, v) = u > 12 ? 113 : 100;
    }
  auto options = with(FitnessFunction::covariance);
  options.half_width_px = 1;
  options.half_height_px = 1;
  // A row: left 100 100 110, right 100 100 113. C = 10 * 13 * (1 - 1/3) = 260/3, means differ by 1.
  EXPECT_NEAR(score_point(pair.view(), options, {16, 16, 4}), 3 * 260.0 / 3.0 * std::exp(-1.0), 1e-4);
}

TEST(ScorePoint, IsHighestAtTheTrueDisparity) {
  const auto pair = shifted_noise(9);
  for (const auto function : kFunctions)
    for (const auto sampling : kSamplings) {
      const auto at = [&](double disparity) {
        return score_point(pair.view(), with(function, sampling), {50, 30, disparity});
      };
      for (const double wrong : {5.0, 8.0, 10.0, 14.0}) EXPECT_GT(at(9.0), 2.0F * at(wrong)) << enum_name(function);
    }
}

TEST(ScorePoint, InterpolatesBetweenColumns) {
  // A ramp of 8 grey levels a column, shifted by half a column: only the sub-pixel patch can match it exactly.
  TestPair pair(40, 32);
  for (int v = 0; v < 32; ++v)
    for (int u = 0; u < 30; ++u) {
      pair.at(pair.left, u, v) = static_cast<std::uint8_t>(8 * u);
      pair.at(pair.right, u, v) = static_cast<std::uint8_t>(8 * u + 4);
    }
  auto options = with(FitnessFunction::louchet, PatchSampling::subpixel);
  options.half_width_px = 3;
  const double G = std::sqrt(8.0);
  EXPECT_NEAR(score_point(pair.view(), options, {15, 15, 0.5}), G / options.louchet_constant, kFloatRounding);
  EXPECT_LT(score_point(pair.view(), options, {15, 15, 0.0}), 0.1 * G / options.louchet_constant);
}

TEST(ScorePoint, IsZeroOnUniformImages) {
  TestPair pair(96, 64);
  std::fill(pair.left.begin(), pair.left.end(), std::uint8_t{128});
  std::fill(pair.right.begin(), pair.right.end(), std::uint8_t{128});
  for (const auto function : kFunctions) EXPECT_EQ(score_point(pair.view(), with(function), {50, 30, 5}), 0.0F);
}

TEST(ScorePoint, IsZeroWhereTheImagesAreOpposite) {
  auto pair = shifted_noise(0);
  for (std::size_t i = 0; i < pair.left.size(); ++i) pair.right[i] = static_cast<std::uint8_t>(255 - pair.left[i]);
  EXPECT_EQ(score_point(pair.view(), with(FitnessFunction::covariance), {50, 30, 0}), 0.0F);
  EXPECT_EQ(score_point(pair.view(), with(FitnessFunction::correlation), {50, 30, 0}), 0.0F);
}

TEST(ScorePoint, IsZeroWhenPatchLeavesAnImage) {
  const auto pair = shifted_noise(0);
  for (const auto function : kFunctions) {
    const auto options = with(function);
    EXPECT_GT(score_point(pair.view(), options, {6, 9, 0}), 0.0F);
    EXPECT_EQ(score_point(pair.view(), options, {5, 9, 0}), 0.0F) << "left edge";
    EXPECT_EQ(score_point(pair.view(), options, {6, 8, 0}), 0.0F) << "top edge";
    EXPECT_EQ(score_point(pair.view(), options, {20, 30, 15}), 0.0F) << "left edge of the right image";
    EXPECT_EQ(score_point(pair.view(), options, {90, 30, 0}), 0.0F) << "right edge";
    EXPECT_EQ(score_point(pair.view(), options, {50, 55, 0}), 0.0F) << "bottom edge";
  }
}

TEST(ScorePoint, IsZeroForCoordinatesThatAreNoNumbers) {
  const auto pair = shifted_noise(0);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const StereoPoint& point :
       {StereoPoint{kNan, 30, 0}, StereoPoint{50, kNan, 0}, StereoPoint{50, 30, kNan}, StereoPoint{kInfinity, 30, 0},
        StereoPoint{50, 30, -kInfinity}, StereoPoint{1e300, 30, 0}})
    EXPECT_EQ(score_point(pair.view(), {}, point), 0.0F);
}

TEST(ScorePoint, TakesImagesSmallerThanThePatch) {
  TestPair pair(1, 1);
  EXPECT_EQ(score_point(pair.view(), {}, {0, 0, 0}), 0.0F);
}

TEST(CorrelatePoint, IsOneForEqualPatchesWithoutNoiseFloor) {
  const auto pair = shifted_noise(9);
  FitnessOptions options;
  options.noise_gray = 0.0;
  EXPECT_NEAR(correlate_point(pair.view(), options, {50, 30, 9}), 1.0, kFloatRounding);
  options.noise_gray = 20.0;
  EXPECT_LT(correlate_point(pair.view(), options, {50, 30, 9}), 0.99);
}

TEST(ScorePoints, ScoresEachPlace) {
  const auto pair = shifted_noise(5);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> u = {50, 30.3F, nan, 50, 50, 3}, v = {30, 20.7F, 30, nan, 30, 30};
  const std::vector<float> disparity = {5, 5.2F, 5, 5, nan, 0};
  for (const auto function : kFunctions)
    for (const auto sampling : kSamplings) {
      const auto options = with(function, sampling);
      std::vector<float> fitness(u.size(), -1.0F), coefficient(u.size(), -1.0F);
      score_points(pair.view(), options, u, v, disparity, fitness);
      correlate_points(pair.view(), options, u, v, disparity, coefficient);
      for (std::size_t i = 0; i < u.size(); ++i) {
        EXPECT_EQ(fitness[i], score_point(pair.view(), options, {u[i], v[i], disparity[i]}));
        EXPECT_EQ(coefficient[i], correlate_point(pair.view(), options, {u[i], v[i], disparity[i]}));
        EXPECT_EQ(fitness[i] > 0.0F, i < 2) << enum_name(function) << ' ' << i;
      }
    }
}

TEST(ScorePoints, RoundsHalvesToEven) {
  const auto pair = shifted_noise(5);
  const auto options = with(FitnessFunction::covariance);
  EXPECT_EQ(score_point(pair.view(), options, {50.5, 30.5, 5}), score_point(pair.view(), options, {50, 30, 4}));
  EXPECT_EQ(score_point(pair.view(), options, {51.5, 31.5, 5}), score_point(pair.view(), options, {52, 32, 6}));
}

TEST(ScorePoints, TakesNoPlaces) {
  const auto pair = shifted_noise(5);
  score_points(pair.view(), {}, {}, {}, {}, {});
  correlate_points(pair.view(), {}, {}, {}, {}, {});
}

StereoCamera small_camera() {
  return {.fx_px = 100,
          .fy_px = 100,
          .cx_px = 48,
          .cx_right_px = 48,
          .cy_px = 32,
          .baseline_m = 0.5,
          .width_px = 96,
          .height_px = 64,
          .mount = {.height_m = 1.0}};
}

TEST(ScoreFlies, ScoresTheProjectionOfEachFly) {
  const auto pair = shifted_noise(5);
  const Projection projection(small_camera());
  Population flies;
  flies.push_back({10.0, 0.0, 1.0});   // disparity 5
  flies.push_back({20.0, 0.0, 1.0});   // disparity 2.5
  flies.push_back({-10.0, 0.0, 1.0});  // behind the camera
  flies.push_back({std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0});
  const auto fitness = score_flies(pair.view(), projection, {}, flies);
  ASSERT_EQ(fitness.size(), flies.size());
  EXPECT_EQ(fitness[0], score_point(pair.view(), {}, projection.project(flies.point(0))));
  EXPECT_GT(fitness[0], 10.0F * fitness[1]);
  EXPECT_EQ(fitness[2], 0.0F);
  EXPECT_EQ(fitness[3], 0.0F);
}

TEST(ScoreFlies, ScoresARangeOfFlies) {
  const auto pair = shifted_noise(5);
  Population flies;
  for (int i = 0; i < 5; ++i) flies.push_back({10.0 + i, 0.0, 1.0});
  const Projection projection(small_camera());
  const auto all = score_flies(pair.view(), projection, {}, flies);
  std::vector<float> some(2);
  score_flies(pair.view(), projection, {}, flies, 2, some);
  EXPECT_EQ(some[0], all[2]);
  EXPECT_EQ(some[1], all[3]);
}

TEST(ScoreFlies, DoesNotDependOnTheNumberOfThreads) {
  const auto pair = shifted_noise(5);
  const Projection projection(small_camera());
  Population flies;
  FlyRandom random(3, 0, 0, 0);
  for (int i = 0; i < 2000; ++i) flies.push_back({random.uniform(2, 40), random.uniform(-5, 5), random.uniform(0, 2)});
  const auto with_threads = [&](int threads) {
    return tbb::task_arena(threads).execute([&] { return score_flies(pair.view(), projection, {}, flies); });
  };
  EXPECT_EQ(with_threads(1), with_threads(4));
}

TEST(KernelTarget, IsOneOfThoseOnOffer) {
  EXPECT_THAT(kernel_target_names(), testing::Contains(kernel_target_name()));
  EXPECT_EQ(kernel_target_names().back(), "scalar");
}

TEST(ScoreFlies, TakesNoFlies) {
  EXPECT_TRUE(score_flies(shifted_noise(0).view(), Projection(small_camera()), {}, {}).empty());
}

}  // namespace
}  // namespace flies
