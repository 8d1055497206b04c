#include "flies/io/kitti_place.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace flies {
namespace {

constexpr double kTolerance_m = 1e-9;  // rounding alone

StereoCamera camera_of(const CameraMount& mount) {
  return {.fx_px = 700.0,
          .fy_px = 720.0,
          .cx_px = 600.0,
          .cx_right_px = 600.0,
          .cy_px = 180.0,
          .baseline_m = 0.5,
          .width_px = 1240,
          .height_px = 370,
          .mount = mount};
}

TEST(KittiPlace, OfALevelCameraIsTheVehicleFrameWithOtherAxes) {
  const auto place = kitti_place(camera_of({.height_m = 1.5}), {10.0, 2.0, 0.0}).value();
  EXPECT_NEAR(place.right_m, -2.0, kTolerance_m);
  EXPECT_NEAR(place.down_m, 1.5, kTolerance_m);
  EXPECT_NEAR(place.forward_m, 10.0, kTolerance_m);
}

TEST(KittiPlace, PitchesWithTheCamera) {
  const double pitch_rad = 0.2, c = std::cos(pitch_rad), s = std::sin(pitch_rad);
  const auto place = kitti_place(camera_of({.height_m = 1.5, .pitch_rad = pitch_rad}), {10.0, 2.0, 0.0}).value();
  EXPECT_NEAR(place.right_m, -2.0, kTolerance_m);
  EXPECT_NEAR(place.down_m, 1.5 * c - 10.0 * s, kTolerance_m);
  EXPECT_NEAR(place.forward_m, 10.0 * c + 1.5 * s, kTolerance_m);
}

TEST(KittiPlace, RollsWithTheCamera) {
  const double roll_rad = 0.1;
  const auto place = kitti_place(camera_of({.height_m = 1.5, .roll_rad = roll_rad}), {10.0, 0.0, 0.0}).value();
  EXPECT_NEAR(std::abs(place.right_m), 1.5 * std::sin(roll_rad), kTolerance_m);
  EXPECT_NEAR(place.down_m, 1.5 * std::cos(roll_rad), kTolerance_m);
}

TEST(KittiPlace, IsNotKnownBehindTheCamera) {
  EXPECT_FALSE(kitti_place(camera_of({}), {-1.0, 0.0, 0.0}));
  EXPECT_FALSE(kitti_place(camera_of({}), {0.0, 0.0, 1.65}));
}

TEST(KittiHeading, IsWithinAHalfTurnEitherWay) {
  EXPECT_NEAR(kitti_heading_rad(0.0), -std::numbers::pi / 2.0, 1e-12);
  EXPECT_NEAR(kitti_heading_rad(0.75 * std::numbers::pi), 0.75 * std::numbers::pi, 1e-12);
  for (double yaw_rad = -3.1; yaw_rad < 3.2; yaw_rad += 0.1)
    EXPECT_LE(std::abs(kitti_heading_rad(yaw_rad)), std::numbers::pi) << yaw_rad;
}

}  // namespace
}  // namespace flies
