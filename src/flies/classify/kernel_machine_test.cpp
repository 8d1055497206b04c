#include "flies/classify/kernel_machine.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>

#include "flies/core/random.hpp"

namespace flies {
namespace {

/// Sums of a few hundred products in single precision, in another order.
constexpr double kSinglePrecision = 1e-5;

std::vector<float> random_values(std::size_t count, std::uint32_t stream) {
  FlyRandom random(3, stream, 0, 0);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(random.below(1000)) / 1000.0F - 0.5F;
  return values;
}

KernelStage random_stage(std::size_t features, std::size_t dimensions, std::size_t vectors) {
  KernelStage stage;
  stage.mean = random_values(features, 0);
  stage.projection = {dimensions, dimensions > 0 ? features : 0, random_values(dimensions * features, 1)};
  const std::size_t columns = dimensions > 0 ? dimensions : features;
  stage.support_vectors = {vectors, columns, random_values(vectors * columns, 2)};
  stage.coefficients = random_values(vectors, 3);
  stage.gamma = 0.02;
  stage.bias = 0.125;
  return stage;
}

void expect_kernel_scores(const KernelStage& stage, std::size_t windows) {
  const std::size_t length = stage.mean.size();
  const auto features = random_values(windows * length, 4);
  const auto scores = KernelMachine(stage).scores(features);
  ASSERT_EQ(scores.size(), windows);
  for (std::size_t w = 0; w < windows; ++w)
    EXPECT_NEAR(scores[w], kernel_score(stage, std::span(features).subspan(w * length, length)), kSinglePrecision);
}

TEST(KernelMachine, ScoresEveryWindowAsItsStageDoes) {
  for (const std::size_t windows : {1U, 3U, 4U, 9U}) {
    expect_kernel_scores(random_stage(90, 21, 37), windows);
    expect_kernel_scores(random_stage(40, 0, 16), windows);
  }
}

TEST(KernelMachine, IsItsBiasWithoutSupportVectors) {
  const KernelStage stage = random_stage(8, 0, 0);
  EXPECT_EQ(KernelMachine(stage).scores(random_values(16, 4)), (std::vector<double>{0.125, 0.125}));
  EXPECT_TRUE(KernelMachine(stage).scores({}).empty());
}

TEST(KernelMachine, IsTheSameOnEveryTarget) {
  const KernelMachine machine(random_stage(90, 21, 37));
  const auto features = random_values(7 * 90, 4);
  const auto expected = machine.scores(features);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    EXPECT_EQ(machine.scores(features), expected) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(Exp2OfNegative, IsThePowerOfTwo) {
  constexpr double kStatedError = 3e-7;
  for (float first = 0.0F; first < 130.0F; first += 0.37F) {
    std::array<float, kernels::kPanelRows> x{};
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = first + 0.01F * static_cast<float>(i);
    auto powers = x;
    kernels::exp2_of_negative(powers);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double expected = std::exp2(-std::min(126.0, static_cast<double>(x[i])));
      EXPECT_NEAR(powers[i], expected, kStatedError * expected);
    }
  }
}

}  // namespace
}  // namespace flies
