#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

#include "flies/eval/people.hpp"
#include "flies/io/test_data.hpp"
#include "flies/train/training_windows.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPairs = "kitti_object/training";

TEST(FindProposals, GivesBackgroundWindowsThatKeepClearOfPeople) {
  const auto folder = testing::find_data(kPairs);
  if (!folder) GTEST_SKIP() << testing::absence(kPairs);
  const auto pictures = find_proposals(std::vector<std::string>{folder->string()}, DetectorOptions{});
  std::size_t people = 0, proposals = 0, kept = 0;
  TrainOptions options;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const TrainingPicture& picture = pictures[i];
    EXPECT_TRUE(picture.has_proposals);
    people += picture.unclear.size();
    proposals += picture.proposals.size();
    const auto windows = windows_without_people(picture, 1242, 375, static_cast<std::uint32_t>(i), 1, 100000, options);
    kept += windows.size();
    for (const auto& w : windows)
      for (const auto& person : picture.unclear)
        EXPECT_LE(intersection_over_union(w.window, window_around(person, options.positives.person_share)), 0.3);
  }
  EXPECT_GT(people, 0U);
  EXPECT_GT(kept, 100U);
  EXPECT_LT(kept, proposals) << "some proposals lie on the labelled people";
}

}  // namespace
}  // namespace flies
