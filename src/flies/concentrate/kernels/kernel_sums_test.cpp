#include "flies/concentrate/kernels/kernel_sums.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <string>
#include <vector>

#include "flies/core/random.hpp"

namespace flies::kernels {
namespace {

/// The exponential's error, relative, and the rounding of a hundred additions.
constexpr double kRelativeError = 1e-13;

constexpr double kBandwidth_px = 6.0;

/// Points in two rows of four cells, of which the middle two cells are meant: as many points as fill vectors and more.
class SumKernel : public testing::TestWithParam<std::int64_t> {
 protected:
  SumKernel() {
    constexpr std::uint32_t kStarts[] = {0, 3, 20, 41, 50, 50, 51, 51, 80};
    starts_.assign(std::begin(kStarts), std::end(kStarts));
    for (std::uint32_t i = 0; i < starts_.back() + kPadding; ++i) {
      FlyRandom random(1, 2, 3, i);
      u_px_.push_back(random.uniform(80, 120));
      v_px_.push_back(random.uniform(30, 70));
      weight_.push_back(random.uniform());
    }
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  PointRuns points() const {
    return {.u_px = u_px_.data(),
            .v_px = v_px_.data(),
            .weight = weight_.data(),
            .starts = starts_.data() + 1,
            .stride = 4,
            .cells = 2,
            .runs = 2};
  }

  std::vector<std::uint32_t> starts_;
  std::vector<double> u_px_, v_px_, weight_;
};

TEST_P(SumKernel, FollowsTheEquation) {
  hwy::SetSupportedTargetsForTest(GetParam());
  const double u_px = 101.3, v_px = 52.1;
  KernelSums expected;
  int within = 0, beyond = 0;
  points().for_each([&](std::size_t i, double point_u_px, double point_v_px) {
    const double du = point_u_px - u_px, dv = point_v_px - v_px;
    const double distance_px = std::hypot(du, dv);
    ++(distance_px <= kKernelReach * kBandwidth_px ? within : beyond);
    if (distance_px > kKernelReach * kBandwidth_px) return;
    const double w = weight_[i] * std::exp(-distance_px * distance_px / (2.0 * kBandwidth_px * kBandwidth_px));
    expected.weight += w;
    expected.du_px += w * du;
    expected.dv_px += w * dv;
  });
  ASSERT_EQ(within + beyond, 39);
  ASSERT_GT(within, 10);
  ASSERT_GT(beyond, 3);
  const auto sums = sum_kernel(points(), u_px, v_px, kBandwidth_px);
  const double error = kRelativeError * expected.weight;
  EXPECT_NEAR(sums.weight, expected.weight, error);
  EXPECT_NEAR(sums.du_px, expected.du_px, error * kKernelReach * kBandwidth_px);
  EXPECT_NEAR(sums.dv_px, expected.dv_px, error * kKernelReach * kBandwidth_px);
}

TEST_P(SumKernel, GivesTheSameNumbersOnEveryTarget) {
  const auto expected = sum_kernel(points(), 99.0, 48.0, kBandwidth_px);
  hwy::SetSupportedTargetsForTest(GetParam());
  const auto sums = sum_kernel(points(), 99.0, 48.0, kBandwidth_px);
  EXPECT_EQ(sums.weight, expected.weight);
  EXPECT_EQ(sums.du_px, expected.du_px);
  EXPECT_EQ(sums.dv_px, expected.dv_px);
}

INSTANTIATE_TEST_SUITE_P(AllTargets, SumKernel, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

}  // namespace
}  // namespace flies::kernels
