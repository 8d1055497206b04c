#include "flies/diagnose/pair_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "flies/diagnose/textured_pair.hpp"

namespace flies {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

StereoCamera camera() {
  return {.fx_px = 400,
          .fy_px = 400,
          .cx_px = 320,
          .cx_right_px = 320,
          .cy_px = 80,
          .baseline_m = 0.5,
          .width_px = 640,
          .height_px = 240,
          .mount = {.height_m = 1.5}};
}

/// A pair whose images are no others' of the run.
GrayPair pair_number(int number) { return textured_pair(10.0 + number, 0.0, 0.0); }
GrayPair with_own_left(GrayPair pair, int number) {
  for (auto& level : pair.left.pixels) level = static_cast<std::uint8_t>(level ^ (number & 1));
  return pair;
}

std::vector<std::string> look(PairWatch& watch, const GrayPair& pair, const std::string& name = "one") {
  return watch.look(pair.view(), camera(), name);
}

TEST(PairWatch, IsSilentOnAGoodRun) {
  PairWatch watch;
  for (int i = 0; i < 4; ++i) EXPECT_THAT(look(watch, with_own_left(pair_number(i), i)), IsEmpty());
  EXPECT_THAT(watch.counts(), IsEmpty());
  EXPECT_FALSE(watch.has_near_things());
}

TEST(PairWatch, TellsABlankImageOnceAndCounts) {
  PairWatch watch;
  for (int i = 0; i < 4; ++i) {
    GrayPair pair = with_own_left(pair_number(i), i);
    if (i % 2 == 1)
      for (std::size_t k = 0; k < pair.left.pixels.size(); ++k)
        pair.left.pixels[k] = static_cast<std::uint8_t>((k * (7 + static_cast<std::size_t>(i))) % 11 % 4);  // noise
    const auto told = look(watch, pair, "pair " + std::to_string(i));
    if (i == 1)
      EXPECT_THAT(told, ElementsAre(HasSubstr("pair 1: there is nothing to match in the left image")));
    else
      EXPECT_THAT(told, IsEmpty());
  }
  EXPECT_THAT(watch.counts(), ElementsAre("2 of 4 pairs: nothing to match in the left image; the first: pair 1"));
}

TEST(PairWatch, TellsSwappedImages) {
  PairWatch watch;
  GrayPair pair = pair_number(0);
  std::swap(pair.left, pair.right);
  EXPECT_THAT(look(watch, pair), ElementsAre(HasSubstr("left and right seem to be swapped")));
}

TEST(PairWatch, TellsImagesThatDoNotBelongTogether) {
  PairWatch watch;
  GrayPair pair = pair_number(0);
  pair.right = textured_pair(8.0, 60.0, 0.0).right;
  EXPECT_THAT(look(watch, pair), ElementsAre(HasSubstr("hardly any place")));
}

TEST(PairWatch, TellsWhichImageRepeats) {
  const GrayPair first = with_own_left(pair_number(0), 0);
  const GrayPair left_alone = with_own_left(pair_number(0), 1), right_alone = pair_number(1);
  PairWatch of_right, of_left, of_both;
  look(of_right, first);
  EXPECT_THAT(look(of_right, left_alone), ElementsAre(HasSubstr("does the right camera hang")));
  look(of_left, first);
  EXPECT_THAT(look(of_left, right_alone), ElementsAre(HasSubstr("does the left camera hang")));
  look(of_both, first);
  EXPECT_THAT(look(of_both, first), ElementsAre(HasSubstr("both images are identical to those of the previous pair")));
  EXPECT_THAT(of_both.counts(), ElementsAre(HasSubstr("1 of 2 pairs: both images are those of the previous pair")));
}

TEST(PairWatch, TellsWhatIsNearerThanIsLookedAt) {
  PairWatch watch;
  const GrayPair pair = pair_number(0);
  StereoCamera high = camera();
  high.mount.height_m = 30.0;  // all that is seen stands far above the road
  const double range_m = high.fx_px * high.baseline_m / 10.0;
  EXPECT_THAT(watch.look(pair.view(), high, "one", {0.7 * range_m}), IsEmpty());
  EXPECT_THAT(watch.look(pair.view(), high, "two", {1.5 * range_m}),
              Contains(HasSubstr("two: something stands nearer than where the search begins")));
  EXPECT_THAT(watch.counts(), Contains("1 of 2 pairs: something nearer than where the search begins; the first: two"));
  EXPECT_TRUE(note_on_near_things(pair.view(), high, {1.5 * range_m}).has_value());
  EXPECT_FALSE(note_on_near_things(pair.view(), high, {0.7 * range_m}).has_value());
  EXPECT_THAT(*note_on_near_things(pair.view(), high, {1.5 * range_m, "default"}), HasSubstr("--preset robot is for"));
  EXPECT_THAT(*note_on_near_things(pair.view(), high, {1.5 * range_m, "robot"}),
              AllOf(HasSubstr("set where the search begins)"), Not(HasSubstr("--preset"))));
  high.mount.height_m = 1.5;  // the road is as near where it is seen
  EXPECT_FALSE(note_on_near_things(pair.view(), high, {1.5 * range_m}).has_value());
}

}  // namespace
}  // namespace flies
