#include "flies/eval/unlabelled.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;

Dataset two_pairs() {
  Dataset dataset;
  dataset.pairs = {{"l/a.png", "r/a.png"}, {"l/b.png", "r/b.png"}};
  dataset.load = [](std::size_t i) {
    TruthFrame frame;
    frame.truth.name = i == 0 ? "a" : "b";
    frame.truth.ignored_regions.push_back({1, 1, 1, 1});
    return frame;
  };
  return dataset;
}

TEST(ParseUnlabelled, ReadsBoxesByPair) {
  const auto boxes =
      parse_unlabelled("# seen by eye\na, 10,20,30.5,60,boy, with a ball\na,1,2,3,4\n\nb,5,6,7,8,\n", "u.csv");
  ASSERT_EQ(boxes.size(), 2u);
  ASSERT_EQ(boxes.at("a").size(), 2u);
  EXPECT_EQ(boxes.at("a")[0].u_px, 10.0);
  EXPECT_EQ(boxes.at("a")[0].width_px, 30.5);
  EXPECT_EQ(boxes.at("b")[0].height_px, 8.0);
}

TEST(ParseUnlabelled, NamesTheLine) {
  EXPECT_THAT(testing::error_of([] { parse_unlabelled("a,1,2,3\n", "u.csv"); }), HasSubstr("u.csv: line 1: found 4"));
  EXPECT_THAT(testing::error_of([] { parse_unlabelled("#\na,1,2,x,4\n", "u.csv"); }), HasSubstr("u.csv: line 2"));
}

TEST(WithUnlabelled, AddsRegionsToTheirPair) {
  const Dataset dataset = with_unlabelled(two_pairs(), {{"b", {{5, 6, 7, 8}}}}, "u.csv");
  EXPECT_EQ(dataset.load(0).truth.ignored_regions.size(), 1u);
  ASSERT_EQ(dataset.load(1).truth.ignored_regions.size(), 2u);
  EXPECT_EQ(dataset.load(1).truth.ignored_regions[1].v_px, 6.0);
}

TEST(WithUnlabelled, RefusesPairsThatAreNotThere) {
  EXPECT_THAT(testing::error_of([] {
                with_unlabelled(two_pairs(), {{"c", {{5, 6, 7, 8}}}}, "u.csv");
              }),
              HasSubstr("u.csv: c: found no pair"));
}

TEST(ParseUnlabelled, BearsMarksAndOtherLineEnds) {
  EXPECT_EQ(parse_unlabelled("\xEF\xBB\xBF"
                             "0001,10,20,30,40\r\n",
                             "u.csv")
                .at("0001")
                .size(),
            1U);
}

}  // namespace
}  // namespace flies
