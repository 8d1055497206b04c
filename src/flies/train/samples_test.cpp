#include "flies/train/samples.hpp"

#include <gmock/gmock.h>

#include <algorithm>

namespace flies {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Samples two_people_and(std::vector<float> background) {
  Samples samples;
  samples.features = {2, 1, {10.0F, 11.0F}};
  samples.is_person = {1, 1};
  samples.people = 2;
  for (const float value : background) {
    samples.features.values.push_back(value);
    ++samples.features.rows;
    samples.is_person.push_back(0);
    samples.background.push_back({static_cast<std::uint32_t>(value), false, {}});
  }
  return samples;
}

TEST(SplitInRuns, KeepsNeighboursTogether) {
  const HoldOut split = split_in_runs(100, 0.2);
  EXPECT_THAT(split.kept_apart, SizeIs(20));
  EXPECT_THAT(split.learnt, SizeIs(80));
  int gaps = 0;
  for (std::size_t i = 1; i < split.kept_apart.size(); ++i) gaps += split.kept_apart[i] != split.kept_apart[i - 1] + 1;
  EXPECT_EQ(gaps, 3) << "four runs of five";
}

TEST(SplitInRuns, LeavesSomethingOnBothSides) {
  for (const double share : {0.01, 0.5, 0.9}) {
    for (const std::size_t count : {2U, 3U, 4U, 19U, 21U}) {
      const HoldOut split = split_in_runs(count, share);
      EXPECT_THAT(split.learnt, ::testing::Not(IsEmpty())) << count << " " << share;
      EXPECT_THAT(split.kept_apart, ::testing::Not(IsEmpty())) << count << " " << share;
      EXPECT_EQ(split.learnt.size() + split.kept_apart.size(), count);
    }
  }
}

TEST(KeepBackground, DropsRowsAndTheirWindowsAndNoPeople) {
  Samples samples = two_people_and({1.0F, 2.0F, 3.0F, 4.0F});
  keep_background(samples, [](std::span<const float> features) { return static_cast<int>(features[0]) % 2 == 0; });
  EXPECT_THAT(samples.features.values, ElementsAre(10.0F, 11.0F, 2.0F, 4.0F));
  EXPECT_EQ(samples.features.rows, 4U);
  EXPECT_THAT(samples.is_person, ElementsAre(1, 1, 0, 0));
  ASSERT_THAT(samples.background, SizeIs(2));
  EXPECT_EQ(samples.background[0].picture, 2U);
  EXPECT_EQ(samples.background[1].picture, 4U);
}

}  // namespace
}  // namespace flies
