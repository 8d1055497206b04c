#include "flies/road/kernels/correlate_shifts.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <string>
#include <vector>

#include "flies/core/random.hpp"
#include "flies/fitness/fitness.hpp"

namespace flies::kernels {
namespace {

constexpr int kWidth_px = 200, kHeight_px = 9;
constexpr double kNoise_gray = 1.5;

/// Both compute in double precision from the same integers and round once.
constexpr float kRounding = 1e-7F;

/// Noise of low and of full contrast, which saturates.
class CorrelateShifts : public testing::TestWithParam<std::int64_t> {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  static std::vector<std::uint8_t> noise(std::uint32_t image, bool saturated) {
    std::vector<std::uint8_t> pixels(kWidth_px * kHeight_px);
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
      FlyRandom random(7, image, 0, i);
      pixels[i] = static_cast<std::uint8_t>(saturated ? 255 * random.below(2) : 100 + random.below(9));
    }
    return pixels;
  }
  static RectifiedPair view(const std::vector<std::uint8_t>& left, const std::vector<std::uint8_t>& right) {
    return {{left.data(), kWidth_px, kHeight_px, kWidth_px}, {right.data(), kWidth_px, kHeight_px, kWidth_px}};
  }
  /// The left neighbourhood around (60, 4), the leftmost right one around (20, 4).
  static std::vector<float> correlate(const RectifiedPair& pair, int fraction16, int shifts) {
    std::vector<float> coefficient(static_cast<std::size_t>(shifts));
    correlate_shifts({.left = pair.left.row(2) + 60 - kShiftColumns / 2,
                      .right = pair.right.row(2) + 20 - kShiftColumns / 2,
                      .left_stride = kWidth_px,
                      .right_stride = kWidth_px,
                      .fraction16 = fraction16,
                      .shifts = shifts,
                      .noise_gray2 = kNoise_gray * kNoise_gray},
                     coefficient.data());
    return coefficient;
  }
};

TEST_P(CorrelateShifts, GivesTheCoefficientsOfCorrelatePoint) {
  hwy::SetSupportedTargetsForTest(GetParam());
  FitnessOptions options;
  options.half_width_px = kShiftColumns / 2;
  options.half_height_px = kShiftRows / 2;
  options.row_step = 1;
  options.noise_gray = kNoise_gray;
  for (const bool saturated : {false, true}) {
    const auto left = noise(0, saturated), right = noise(1, saturated);
    const auto pair = view(left, right);
    for (const int fraction16 : {0, 1, 8, 15}) {
      const auto coefficient = correlate(pair, fraction16, kMaxShifts);
      for (std::size_t s = 0; s < coefficient.size(); ++s) {
        const double u_right_px = 20.0 + static_cast<double>(s) + fraction16 / 16.0;
        EXPECT_NEAR(coefficient[s], correlate_point(pair, options, {60.0, 4.0, 60.0 - u_right_px}), kRounding);
      }
    }
  }
}

TEST_P(CorrelateShifts, GivesTheSameNumbersOnEveryTargetAndForEveryNumberOfShifts) {
  const auto left = noise(0, true), right = noise(1, true);
  const auto expected = correlate(view(left, right), 5, kMaxShifts);
  hwy::SetSupportedTargetsForTest(GetParam());
  for (int shifts = 0; shifts <= kMaxShifts; ++shifts) {
    const auto coefficient = correlate(view(left, right), 5, shifts);
    for (std::size_t s = 0; s < coefficient.size(); ++s) EXPECT_EQ(coefficient[s], expected[s]);
  }
}

TEST_P(CorrelateShifts, IsZeroWithoutTexture) {
  hwy::SetSupportedTargetsForTest(GetParam());
  const std::vector<std::uint8_t> gray(kWidth_px * kHeight_px, 77);
  const auto coefficients = correlate(view(gray, gray), 3, 20);
  ASSERT_EQ(coefficients.size(), 20U);
  for (const float coefficient : coefficients) EXPECT_EQ(coefficient, 0.0F);
}

INSTANTIATE_TEST_SUITE_P(AllTargets, CorrelateShifts, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

}  // namespace
}  // namespace flies::kernels
