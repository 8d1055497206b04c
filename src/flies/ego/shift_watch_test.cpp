#include "flies/ego/shift_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace flies {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

StereoCamera camera() {
  StereoCamera c;
  c.fx_px = c.fy_px = 700.0;
  c.baseline_m = 0.5;  // 17.5 px at 20 m
  c.cx_px = c.cx_right_px = 600.0;
  return c;
}

EgoMotion with_shift(double px) {
  EgoMotion ego;
  ego.disparity_shift = DisparityShift{px, 0.2};
  return ego;
}

TEST(DisparityShiftWatch, TellsTheMedianOnceWhenItIsSure) {
  DisparityShiftWatch watch;
  for (int i = 0; i < 9; ++i) {
    watch.look(with_shift(i % 2 == 0 ? -5.2 : -4.8));
    watch.look(EgoMotion{});  // tells nothing
    EXPECT_FALSE(watch.shift());
    EXPECT_THAT(watch.first_note(camera()), IsEmpty());
  }
  watch.look(with_shift(20.0));  // one that is wrong
  ASSERT_TRUE(watch.shift());
  EXPECT_NEAR(watch.shift()->px, -5.0, 0.21);
  const std::string note = watch.first_note(camera());
  EXPECT_THAT(note, HasSubstr("all disparities are 5.0 px too large (10 pairs"));
  EXPECT_THAT(note, HasSubstr("what is reported at 20 m is really at 28.0 m"));
  EXPECT_THAT(note, HasSubstr("until then --disparity-shift -5.0 corrects it"));
  EXPECT_THAT(note, HasSubstr("cx of the right camera should be 595.0"));
  watch.look(with_shift(-5.0));
  EXPECT_THAT(watch.first_note(camera()), IsEmpty());
}

TEST(DisparityShiftWatch, IsSilentOnSmallShiftsAndOnThoseThatDiffer) {
  DisparityShiftWatch small, unsure;
  for (int i = 0; i < 30; ++i) {  // too few to tell so little
    small.look(with_shift(2.0));
    unsure.look(with_shift(i % 3 == 0 ? 4.0 : i % 3 == 1 ? 1.0 : 7.0));
  }
  EXPECT_NEAR(small.shift()->px, 2.0, 1e-9);
  EXPECT_THAT(small.first_note(camera()), IsEmpty());
  for (int i = 0; i < 10; ++i) small.look(with_shift(2.0));
  EXPECT_THAT(small.first_note(camera()), HasSubstr("2.0 px too small (40 pairs"));
  EXPECT_NEAR(unsure.shift()->px, 4.0, 1e-9);
  EXPECT_THAT(unsure.first_note(camera()), IsEmpty());
}

TEST(DisparityShiftWatch, ForgetsWhatIsLongAgo) {
  DisparityShiftWatch watch;
  for (int i = 0; i < 300; ++i) watch.look(with_shift(0.0));
  for (int i = 0; i < 200; ++i) watch.look(with_shift(8.0));  // the rig was knocked
  EXPECT_NEAR(watch.shift()->px, 8.0, 1e-9);
  EXPECT_THAT(watch.first_note(camera()), HasSubstr("too small"));
}

TEST(NoteOnShift, NamesARangeThatIsFiniteInTruth) {
  EXPECT_THAT(note_on_shift({-16.0, 0.5}, 12, camera()), HasSubstr("reported at 10 m is really at 18.4 m"));
  EXPECT_THAT(note_on_shift({-60.0, 0.5}, 12, camera()), HasSubstr("reported at 2 m is really at 3.0 m"));
  EXPECT_THAT(note_on_shift({-600.0, 0.5}, 12, camera()), HasSubstr("reported at 1 m is really far beyond that"));
}

}  // namespace
}  // namespace flies
