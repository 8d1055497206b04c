#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/road/find_mount.hpp"
#include "flies/road/ground_plane.hpp"

namespace flies {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kScale_px_m = 387.0;
constexpr double kHeight_m = 1.65;

/// What is found where the road's disparities are other by so much: everywhere, and at depth 1 to the right.
MountFinding found_with(double offset_px, double to_the_right_px, double farthest_px) {
  const CameraMount told{kHeight_m, 0.0, 0.0};
  GroundPlane plane = plane_below(told, kScale_px_m);
  plane.ahead_px += offset_px;
  plane.across_px += to_the_right_px;
  return {.told = told,
          .mount = mount_above(plane, kScale_px_m),
          .is_replaced = true,
          .scale_px_m = kScale_px_m,
          .farthest_px = farthest_px};
}

TEST(MountNote, DoubtsThePrincipalPointWhereAPitchAloneIsSeenAndNothingFarAway) {
  const auto note = mount_note(found_with(20.0, 0.0, 19.0));
  ASSERT_TRUE(note);
  EXPECT_THAT(*note, HasSubstr("4.9 degrees down"));
  EXPECT_THAT(
      *note,
      HasSubstr(
          "farther away than 20.4 m: if the camera does look 0.0 degrees down, cx of one camera is some 19 px off"));
}

TEST(MountNote, DoesNotDoubtThePrincipalPointWhereSomethingIsFarAway) {
  EXPECT_THAT(*mount_note(found_with(20.0, 0.0, 2.0)), Not(HasSubstr("cx")));
}

TEST(MountNote, DoesNotDoubtThePrincipalPointOfACameraAtAnotherHeight) {
  MountFinding finding = found_with(20.0, 0.0, 19.0);
  finding.mount.height_m = 1.2;
  EXPECT_THAT(*mount_note(finding), Not(HasSubstr("cx")));
}

TEST(MountNote, AsksForOtherWidthsWhereARollAloneIsSeen) {
  const auto note = mount_note(found_with(0.0, 22.0, 2.0));
  ASSERT_TRUE(note);
  EXPECT_THAT(*note, HasSubstr("leans 5.4 to the right"));
  EXPECT_THAT(*note, HasSubstr("If the camera does lean 0.0 to the right, one image is narrower than the other"));
  EXPECT_THAT(*mount_note(found_with(20.0, 22.0, 2.0)), Not(HasSubstr("narrower")));
}

TEST(MountNote, SaysNothingOfWhatIsAsTold) {
  MountFinding finding = found_with(20.0, 22.0, 19.0);
  finding.is_replaced = false;
  EXPECT_FALSE(mount_note(finding));
}

/// A mount that the road confirms, where it rises by so many pixels.
MountFinding confirmed_with(double rise_px, double farthest_px) {
  return {.told = {kHeight_m, 0.0, 0.0},
          .mount = {kHeight_m, 0.0, 0.0},
          .is_confirmed = true,
          .scale_px_m = kScale_px_m,
          .slope = rise_px * kHeight_m / kScale_px_m,
          .farthest_px = farthest_px};
}

TEST(MountNote, DoubtsThePrincipalPointOfAConfirmedMountWhereTheRoadRisesAndNothingIsFarAway) {
  const auto note = mount_note(confirmed_with(6.0, 16.0));
  ASSERT_TRUE(note);
  EXPECT_THAT(*note, HasSubstr("farther away than 24 m"));
  EXPECT_THAT(*note, HasSubstr("looked 1.5 degrees farther down"));
  EXPECT_THAT(*note, HasSubstr("cx of one camera is some 6 to 16 px off"));
  EXPECT_FALSE(mount_note(confirmed_with(6.0, 6.0)));    // something is far away
  EXPECT_FALSE(mount_note(confirmed_with(2.0, 16.0)));   // the road is level, but the view closed
  EXPECT_FALSE(mount_note(confirmed_with(-6.0, 16.0)));  // the camera looks up
  EXPECT_FALSE(mount_note(confirmed_with(6.0, 30.0)));   // a room
}

TEST(MountNote, DoubtsThePrincipalPointLikewiseWhereTheMountIsReplaced) {
  EXPECT_THAT(*mount_note(found_with(6.0, 0.0, 16.0)), HasSubstr("cx of one camera is some 6 to 16 px off"));
}

TEST(MountNote, NamesTheBaselineWhereGroundLiesDeep) {
  MountFinding finding{
      .told = {kHeight_m, 0.0, 0.0}, .mount = {}, .baseline_m = 1.2, .scale_px_m = kScale_px_m, .deep_ground_m = 16.0};
  EXPECT_THAT(*mount_note(finding),
              HasSubstr("16.0 m below this camera: if it is that high, give --camera-height 16.0; if not, its baseline "
                        "of 1.2 m is too long (was it meant in decimetres, 0.12 m?)"));
  finding.deep_ground_m = 70.0;
  EXPECT_THAT(*mount_note(finding), HasSubstr("inches, 0.0305 m?"));
  finding.deep_ground_m = 5.3;
  EXPECT_THAT(*mount_note(finding), HasSubstr("feet, 0.366 m?"));
  finding.deep_ground_m = 33.0;
  EXPECT_THAT(*mount_note(finding), HasSubstr("0.06 m would put the road 1.65 m below it"));
}

TEST(MountNote, SaysUpAndLeftOfACameraThatLooksUpAndLeansToTheLeft) {
  MountFinding finding = found_with(0.0, 0.0, 2.0);
  finding.mount.pitch_rad = radians(-13.9);
  finding.mount.roll_rad = radians(-0.04);
  auto note = mount_note(finding);
  EXPECT_THAT(*note, HasSubstr("looks 13.9 degrees up and leans 0.0 to the right, not 1.65 m, 0.0 degrees down"));
  EXPECT_THAT(*note, HasSubstr("--camera-pitch -13.9 --camera-roll 0.0,"));
  EXPECT_EQ(tilt_words({1.0, radians(-2.0), radians(-3.0)}), "2.0 degrees up, 3.0 to the left");
}

}  // namespace
}  // namespace flies
