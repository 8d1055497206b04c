#include "flies/evolve/kernels/rivals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <string>
#include <vector>

#include "flies/core/random.hpp"

namespace flies::kernels {
namespace {

constexpr int kWidth_px = 160, kHeight_px = 90;

/// Flies all over the image and a little beyond, some without fitness, crowded enough that about half have a rival.
struct Swarm {
  std::vector<float> fitness, u_px, v_px, disparity_px;

  explicit Swarm(std::size_t count) {
    FlyRandom random(4, 0, 0, static_cast<std::uint32_t>(count));
    for (std::size_t i = 0; i < count; ++i) {
      fitness.push_back(i % 5 == 0 ? 0.0F : static_cast<float>(random.uniform()));
      u_px.push_back(static_cast<float>(random.uniform(-5, kWidth_px + 5)));
      v_px.push_back(static_cast<float>(random.uniform(-5, kHeight_px + 5)));
      disparity_px.push_back(static_cast<float>(random.uniform(0, 8)));
    }
  }
};

/// Twice on the same memory: a search must leave it as it found it.
std::vector<std::uint8_t> search_twice(void (*mark)(const RivalSearch&, std::uint8_t*), const Swarm& swarm, float shift,
                                       float margin) {
  const Cells cells(kWidth_px, kHeight_px, 5, 7);
  std::vector<Look> looks(swarm.fitness.size()), fittest(cells.size() + 2);
  std::vector<std::uint32_t> cell_of_fly(swarm.fitness.size()), listed(swarm.fitness.size() + 1);
  const RivalSearch search{.fitness = swarm.fitness.data(),
                           .u_px = swarm.u_px.data(),
                           .v_px = swarm.v_px.data(),
                           .disparity_px = swarm.disparity_px.data(),
                           .flies = swarm.fitness.size(),
                           .shift = shift,
                           .cells = cells,
                           .reach_u_px = 5,
                           .reach_v_px = 7,
                           .disparity_gap_px = 2,
                           .margin = margin,
                           .looks = looks.data(),
                           .cell_of_fly = cell_of_fly.data(),
                           .listed = listed.data(),
                           .fittest = fittest.data()};
  std::vector<std::uint8_t> rivalled(swarm.fitness.size());
  mark(search, rivalled.data());
  std::fill(rivalled.begin(), rivalled.end(), std::uint8_t{0});
  mark(search, rivalled.data());
  return rivalled;
}

class MarkRivalled : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(MarkRivalled, AgreesWithThePlainLoops) {
  // Populations of all remainders of the vector length.
  for (std::size_t count = 0; count < 40; ++count)
    EXPECT_EQ(search_twice(mark_rivalled, Swarm(count), 0, 1), search_twice(mark_rivalled_scalar, Swarm(count), 0, 1));
  const Swarm swarm(400);
  for (const float shift : {0.0F, 1.0F})
    for (const float margin : {1.0F, 1.3F}) {
      const auto expected = search_twice(mark_rivalled_scalar, swarm, shift, margin);
      EXPECT_EQ(search_twice(mark_rivalled, swarm, shift, margin), expected);
      EXPECT_THAT(expected, testing::AllOf(testing::Contains(0), testing::Contains(1)));
    }
}

INSTANTIATE_TEST_SUITE_P(AllTargets, MarkRivalled, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

}  // namespace
}  // namespace flies::kernels
