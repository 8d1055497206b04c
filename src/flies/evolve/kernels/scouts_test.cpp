#include "flies/evolve/kernels/scouts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "flies/evolve/operators.hpp"

namespace flies {
namespace {

constexpr int kWidth_px = 300, kHeight_px = 150;

/// Rounding of disparities in single precision, the polynomials behind powers included.
constexpr double kRounding_px = 2e-3;

/// Flies whose choice single precision changes: a row that begins a column further, a place across a border.
constexpr double kBorderCases = 0.02;

class ScoutFlies : public testing::TestWithParam<std::int64_t> {
 protected:
  ScoutFlies() {
    FlyRandom random(5, 0, 0, 0);
    for (auto* pixels : {&left_, &right_})
      for (int i = 0; i < kWidth_px * kHeight_px; ++i)
        pixels->push_back(static_cast<std::uint8_t>(i % 7 < 2 ? 255 * random.below(2) : random.below(256)));
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  Habitat habitat() const {
    const StereoCamera camera{.fx_px = 200,
                              .fy_px = 200,
                              .cx_px = 150,
                              .cx_right_px = 148,
                              .cy_px = 60,
                              .baseline_m = 0.4,
                              .mount = {.height_m = 1.4, .pitch_rad = 0.04, .roll_rad = 0.02}};
    return {Projection(camera),
            {{left_.data(), kWidth_px, kHeight_px, kWidth_px}, {right_.data(), kWidth_px, kHeight_px, kWidth_px}},
            {.height_m = 0.1, .slope = 0.02},
            {.y_min_m = -8, .y_max_m = 6}};
  }

  /// Anywhere in the left image and a little beyond.
  static ImagePopulation swarm(std::size_t count) {
    ImagePopulation flies;
    flies.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      FlyRandom random(7, 0, 0, static_cast<std::uint32_t>(i));
      flies.set(i, {random.uniform(-5, kWidth_px + 5), random.uniform(-5, kHeight_px + 5), random.uniform(1, 30)});
    }
    return flies;
  }

  std::vector<std::uint8_t> left_, right_;
};

TEST_P(ScoutFlies, AgreesWithScoutingOneByOne) {
  hwy::SetSupportedTargetsForTest(GetParam());
  constexpr std::size_t kFlies = 2000;
  const auto before = swarm(kFlies);
  for (const int scouts : {1, 5, 16, kernels::kMaxScouts}) {
    auto flies = before;
    scout(habitat(), scouts, {1, 2, 3, 4, kFlies}, 0, flies);
    int moved = 0, others = 0;
    for (std::size_t i = 0; i < kFlies; ++i) {
      const auto expected =
          scout(habitat(), scouts, before.point(i), FlyDraws(1, 2, 3, 4 + static_cast<std::uint32_t>(i)));
      moved += flies.disparity_px[i] != before.disparity_px[i];
      others += std::abs(flies.disparity_px[i] - expected.disparity_px) > kRounding_px;
    }
    EXPECT_LE(others, kBorderCases * kFlies) << scouts;
    EXPECT_GT(moved, kFlies / 4) << scouts;
  }
}

TEST_P(ScoutFlies, GivesTheSameFliesOnEveryTargetAndInEveryPart) {
  auto expected = swarm(300);
  scout(habitat(), 16, {1, 2, 3, 4, 300}, 0, expected);
  hwy::SetSupportedTargetsForTest(GetParam());
  for (const std::size_t part : {std::size_t{300}, std::size_t{64}, std::size_t{7}}) {
    auto flies = swarm(300);
    for (std::size_t begin = 0; begin < 300; begin += part)
      scout(habitat(), 16, {1, 2, 3, 4 + static_cast<std::uint32_t>(begin), std::min(part, 300 - begin)}, begin, flies);
    EXPECT_EQ(flies.disparity_px, expected.disparity_px);
  }
}

INSTANTIATE_TEST_SUITE_P(AllTargets, ScoutFlies, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

}  // namespace
}  // namespace flies
