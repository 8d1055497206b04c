#include "flies/classify/convolution.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "flies/classify/kernels/convolve.hpp"

namespace flies {
namespace {

/// Numbers for one convolution, and what comes out of it by the words of its description.
struct Example {
  std::size_t width, height, stride, pairs, outputs;
  std::vector<std::int16_t> input, weights;
  std::vector<float> scale, offset;

  Example(std::size_t w, std::size_t h, std::size_t s, std::size_t p, std::size_t o, std::int16_t most_input,
          std::int16_t most_weight)
      : width(w), height(h), stride(s), pairs(p), outputs(o), scale(o), offset(o) {
    std::mt19937 random(7);
    std::uniform_int_distribution<int> level(0, most_input), weight(-most_weight, most_weight);
    input.resize(input_row() * (height * stride + 2));
    weights.resize(9 * pairs * outputs * 2);
    for (auto& value : input) value = static_cast<std::int16_t>(level(random));
    for (auto& value : weights) value = static_cast<std::int16_t>(weight(random));
    for (std::size_t i = 0; i < outputs; ++i) {
      scale[i] = 1.0F / (100.0F + 37.0F * static_cast<float>(i) * most_weight);
      offset[i] = static_cast<float>(i % 7) * 100.0F - 300.0F;
    }
  }
  std::size_t input_row() const { return (width * stride + 2) * pairs * 2; }
  std::size_t output_row() const { return (width + 2) * outputs; }

  std::vector<std::int16_t> by_kernel() const {
    std::vector<std::int16_t> output(output_row() * height, -1);
    kernels::convolve({width, height, stride, pairs, outputs, weights.data(), scale.data(), offset.data()},
                      input.data(), input_row(), output.data(), output_row());
    return output;
  }
  std::vector<std::int16_t> by_description() const {
    std::vector<std::int16_t> output(output_row() * height, -1);
    for (std::size_t v = 0; v < height; ++v)
      for (std::size_t u = 0; u < width; ++u)
        for (std::size_t o = 0; o < outputs; ++o) {
          std::int64_t sum = 0;
          for (std::size_t tap = 0; tap < 9; ++tap)
            for (std::size_t i = 0; i < 2 * pairs; ++i)
              sum +=
                  std::int64_t{input[(v * stride + tap / 3) * input_row() + (u * stride + tap % 3) * 2 * pairs + i]} *
                  weights[((tap * pairs + i / 2) * outputs + o) * 2 + i % 2];
          const float level = static_cast<float>(sum) * scale[o];
          const float moved = level + offset[o];
          output[v * output_row() + u * outputs + o] =
              static_cast<std::int16_t>(std::nearbyint(std::min(std::max(moved, 0.0F), kernels::kMostActive)));
        }
    return output;
  }
};

class ConvolveOnTarget : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(ConvolveOnTarget, IsWhatItsDescriptionSays) {
  for (const std::size_t width : {1U, 2U, 3U, 6U, 10U, 24U})
    for (const std::size_t stride : {1U, 2U})
      for (const std::size_t outputs : {16U, 32U, 48U}) {
        const Example example(width, 3, stride, 5, outputs, 300, 60);
        EXPECT_EQ(example.by_kernel(), example.by_description()) << width << " " << stride << " " << outputs;
      }
}

TEST_P(ConvolveOnTarget, HoldsTheLargestSums) {
  // 9 x 2 inputs of 4095 with weights up to 2047: the largest that a layer of two channels may have.
  const Example example(6, 2, 1, 1, 16, 4095, 2047);
  EXPECT_EQ(example.by_kernel(), example.by_description());
}

INSTANTIATE_TEST_SUITE_P(Targets, ConvolveOnTarget, testing::ValuesIn([] {
                           std::vector<std::int64_t> targets;
                           for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1)
                             targets.push_back(left & -left);
                           return targets;
                         }()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

/// Of two small layers with random weights.
ConvolutionStage example_stage() {
  std::mt19937 random(3);
  std::normal_distribution<float> weight(0.0F, 0.3F);
  const auto numbers = [&](std::size_t count) {
    std::vector<float> values(count);
    for (float& value : values) value = weight(random);
    return values;
  };
  ConvolutionStage stage;
  stage.layers.push_back({2, {5, 9, numbers(45)}, numbers(5), 12.0});
  stage.layers.push_back({2, {3, 45, numbers(135)}, numbers(3), 20.0});
  stage.last = numbers(12 * 24 * 3);
  stage.bias = 0.5;
  return stage;
}

TEST(ConvolutionMachine, ScoresAsTheStageIsDefined) {
  // A step of 1/2048 of the inputs and 1/4095 of the activations: errors of a thousandth, over 864 terms.
  constexpr double kRounding = 0.05;
  const ConvolutionStage stage = example_stage();
  const ConvolutionMachine machine(stage);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> level(-2.5F, 2.5F);
  double lowest = 1e9, highest = -1e9;
  for (int i = 0; i < 5; ++i) {
    std::vector<float> input(std::size_t{48} * 96);
    for (float& value : input) value = level(random);
    const double score = convolution_score(stage, input);
    EXPECT_NEAR(machine.score(input), score, kRounding);
    lowest = std::min(lowest, score);
    highest = std::max(highest, score);
  }
  EXPECT_GT(highest - lowest, 10.0 * kRounding) << "the example should tell inputs apart";
}

TEST(ConvolutionInput, DoesNotHangOnBrightnessAndContrast) {
  std::vector<float> levels(std::size_t{48} * 96), brighter;
  for (std::size_t i = 0; i < levels.size(); ++i) levels[i] = static_cast<float>(20 + i * 7 % 60);
  for (const float level : levels) brighter.push_back(30.0F + 2.0F * level);
  normalise_levels(levels);
  normalise_levels(brighter);
  constexpr float kRounding = 1e-5F;  // of single precision about 1
  for (std::size_t i = 0; i < levels.size(); ++i) EXPECT_NEAR(levels[i], brighter[i], kRounding);
}

TEST(ConvolutionInput, IsZeroOfAFlatWindow) {
  std::vector<float> levels(std::size_t{48} * 96, 90.0F);
  normalise_levels(levels);
  for (const float level : levels) EXPECT_EQ(level, 0.0F);
}

}  // namespace
}  // namespace flies
