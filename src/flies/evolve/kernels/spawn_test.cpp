#include "flies/evolve/kernels/spawn.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <string>
#include <vector>

#include "flies/evolve/operators.hpp"

namespace flies {
namespace {

constexpr int kWidth_px = 400, kHeight_px = 200;
/// The right image shows what the left one does, by so much to the left.
constexpr int kDisparity_px = 20, kStride = kWidth_px + kDisparity_px;

constexpr auto kImage = InitialDistribution::image, kRatios = InitialDistribution::ratios;

/// Rounding of coordinates in single precision.
constexpr double kRounding_px = 1e-3;

/// Flies that single precision puts across a border of the field or of a pixel, and that are then drawn again or not.
constexpr double kBorderCases = 0.01;

class SpawnFlies : public testing::TestWithParam<std::int64_t> {
 protected:
  SpawnFlies() : pixels_(kStride * kHeight_px) {
    // Places of no contrast and of much, wider and narrower than the window.
    FlyRandom random(6, 0, 0, 0);
    for (int v = 0; v < kHeight_px; ++v)
      for (int u = 0; u < kStride; u += 10) {
        const auto gray = static_cast<std::uint8_t>(random.below(4) == 0 ? random.below(256) : 100);
        for (int i = u; i < u + 10; ++i) pixels_[static_cast<std::size_t>(v * kStride + i)] = gray;
      }
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  Habitat habitat() const {
    const StereoCamera camera{.fx_px = 300,
                              .fy_px = 300,
                              .cx_px = 200,
                              .cx_right_px = 195,
                              .cy_px = 80,
                              .baseline_m = 0.5,
                              .mount = {.height_m = 1.4, .pitch_rad = 0.04, .roll_rad = 0.02}};
    return {Projection(camera),
            {{pixels_.data(), kWidth_px, kHeight_px, kStride},
             {pixels_.data() + kDisparity_px, kWidth_px, kHeight_px, kStride}},
            {.height_m = 0.1, .slope = 0.02},
            {.y_min_m = -8, .y_max_m = 6}};
  }
  static EvolveOptions spawning(double informative_gray, InitialDistribution initial) {
    EvolveOptions options;
    options.informative_gray = informative_gray;
    options.initial = initial;
    return options;
  }
  ImagePopulation spawned(const EvolveOptions& options, std::size_t count) const {
    ImagePopulation flies;
    flies.resize(count + 2);
    spawn(habitat(), options, {1, 2, 3, 4, count}, 2, flies);
    return flies;
  }

  std::vector<std::uint8_t> pixels_;
};

TEST_P(SpawnFlies, AgreesWithSpawningOneByOne) {
  hwy::SetSupportedTargetsForTest(GetParam());
  constexpr std::size_t kFlies = 1000;
  for (const auto& options :
       {spawning(0, kImage), spawning(12, kImage), spawning(200, kImage), spawning(12, kRatios)}) {
    const auto flies = spawned(options, kFlies);
    double others = 0;
    for (std::size_t k = 0; k < kFlies; ++k) {
      const auto fly = flies.point(k + 2);
      const auto expected = spawn(habitat(), options, FlyDraws(1, 2, 3, 4 + static_cast<std::uint32_t>(k)));
      others += std::abs(fly.u_px - expected.u_px) > kRounding_px ||
                std::abs(fly.v_px - expected.v_px) > kRounding_px ||
                std::abs(fly.disparity_px - expected.disparity_px) > kRounding_px;
    }
    EXPECT_LE(others, kBorderCases * kFlies) << options.informative_gray << ' ' << enum_name(options.initial);
  }
}

TEST_P(SpawnFlies, GivesTheSameFliesOnEveryTargetAndInEveryPart) {
  const auto expected = spawned(spawning(12, kRatios), 300);
  hwy::SetSupportedTargetsForTest(GetParam());
  const auto flies = spawned(spawning(12, kRatios), 300);
  EXPECT_EQ(flies.u_px, expected.u_px);
  EXPECT_EQ(flies.v_px, expected.v_px);
  EXPECT_EQ(flies.disparity_px, expected.disparity_px);
  for (std::size_t count = 0; count < 20; ++count) {
    const auto some = spawned(spawning(12, kRatios), count);
    for (std::size_t i = 2; i < some.size(); ++i) EXPECT_EQ(some.v_px[i], expected.v_px[i]);
  }
}

INSTANTIATE_TEST_SUITE_P(AllTargets, SpawnFlies, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

}  // namespace
}  // namespace flies
