#include "flies/concentrate/whole_obstacles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace flies {
namespace {

/// A sector and the rounding of bearings to it.
constexpr double kSector_rad = 0.01;
constexpr double kSectors_m = 0.25;  ///< two sectors at 10 m, and some

Projection projection() {
  StereoCamera camera;
  camera.fx_px = camera.fy_px = 700;
  camera.cx_px = camera.cx_right_px = 600;
  camera.cy_px = 180;
  camera.baseline_m = 0.5;
  return Projection(camera);
}

/// Free everywhere.
Scan open_scan() {
  constexpr std::size_t kSectors = 101;
  Scan scan;
  scan.angle_min_rad = -0.5;
  scan.angle_increment_rad = kSector_rad;
  scan.ranges_m.assign(kSectors, std::numeric_limits<double>::quiet_NaN());
  scan.free_m.assign(kSectors, 40.0);
  scan.confidence.assign(kSectors, 1.0);
  scan.states.assign(kSectors, SectorState::free);
  return scan;
}

/// Something at one range over these bearings.
void put(Scan& scan, double range_m, double right_rad, double left_rad) {
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (scan.angle_rad(i) >= right_rad - 1e-9 && scan.angle_rad(i) <= left_rad + 1e-9) {
      scan.states[i] = SectorState::obstacle;
      scan.ranges_m[i] = range_m;
    }
}

Obstacle obstacle_at(double range_m, double angle_rad, double width_m, double height_m = 1.0) {
  Obstacle obstacle;
  obstacle.x_m = range_m * std::cos(angle_rad);
  obstacle.y_m = range_m * std::sin(angle_rad);
  obstacle.range_m = range_m;
  obstacle.width_m = width_m;
  obstacle.height_m = height_m;
  obstacle.score = 0.1;
  return obstacle;
}

std::vector<Obstacle> make_whole(const std::vector<Obstacle>& obstacles, const Scan& scan,
                                 const WholeOptions& options = {}) {
  return whole_obstacles(obstacles, scan, projection(), {}, options);
}

TEST(WholeObstacles, GrowToTheEndsOfTheirSurface) {
  Scan scan = open_scan();
  put(scan, 10.0, -0.1, 0.1);
  const auto whole = make_whole({obstacle_at(10.0, 0.05, 0.5)}, scan);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_NEAR(whole[0].width_m, 2.1, kSectors_m);
  EXPECT_NEAR(whole[0].y_m, 0.5, kSectors_m);
  EXPECT_NEAR(whole[0].middle_offset_m, -0.5, kSectors_m);
  EXPECT_NEAR(whole[0].range_m, 10.0, 1e-9);
  EXPECT_NEAR(whole[0].box.width_px, 700 * 2.1 / 10.0, 700 * kSectors_m / 10.0);
}

TEST(WholeObstacles, StandWhereTheirSurfaceIsNearest) {
  // A wall that recedes to the left: 10 m away at its right end, 14 m at its left one.
  Scan scan = open_scan();
  for (int i = 0; i <= 20; ++i) put(scan, 10.0 + 0.2 * i, 0.01 * i, 0.01 * i);
  const auto whole = make_whole({obstacle_at(10.0, 0.02, 0.5)}, scan);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_NEAR(std::atan2(whole[0].y_m, whole[0].x_m), 0.02, kSector_rad);
  EXPECT_NEAR(whole[0].range_m, 10.0, 0.3);
  EXPECT_NEAR(whole[0].middle_offset_m, 10.0 * (0.1 - 0.02), kSectors_m);
  EXPECT_NEAR(whole[0].depth_m, 4.0, 0.3);
}

TEST(WholeObstacles, TwoEdgesOfOneSurfaceAreOneObstacle) {
  Scan scan = open_scan();
  put(scan, 10.0, -0.1, 0.1);
  const auto whole = make_whole({obstacle_at(10.0, -0.09, 0.3, 1.2), obstacle_at(10.1, 0.09, 0.3, 1.6)}, scan);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_NEAR(whole[0].width_m, 2.1, kSectors_m);
  EXPECT_EQ(whole[0].height_m, 1.6);
  EXPECT_NEAR(whole[0].score, 0.2, 1e-12);
}

TEST(WholeObstacles, KeepAPersonBeforeAWallApart) {
  Scan scan = open_scan();
  put(scan, 14.0, -0.2, 0.2);
  put(scan, 10.0, -0.03, 0.03);
  const auto whole = make_whole({obstacle_at(10.0, 0.0, 0.5), obstacle_at(14.0, 0.1, 1.0)}, scan);
  ASSERT_GE(whole.size(), 2U);
  EXPECT_NEAR(whole[0].range_m, 10.0, 1e-9);
  EXPECT_NEAR(whole[0].width_m, 0.7, kSectors_m);
}

TEST(WholeObstacles, StayApartWhereTheScanSeesThroughTheGap) {
  Scan scan = open_scan();
  put(scan, 10.0, -0.1, -0.05);
  put(scan, 10.0, 0.05, 0.1);
  EXPECT_EQ(make_whole({obstacle_at(10.0, -0.07, 0.3), obstacle_at(10.0, 0.07, 0.3)}, scan).size(), 2U);
}

TEST(WholeObstacles, AddWhatTheScanAloneSees) {
  Scan scan = open_scan();
  put(scan, 12.0, 0.1, 0.3);
  const auto whole = make_whole({}, scan);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_NEAR(whole[0].width_m, 2.5, kSectors_m);
  EXPECT_EQ(whole[0].score, 0.0);
  EXPECT_TRUE(make_whole({}, scan, {.min_new_confidence = 1.01}).empty());
}

TEST(WholeObstacles, OfALongWallAreStretchesOfTheLargestWidth) {
  Scan scan = open_scan();
  put(scan, 20.0, -0.5, 0.5);
  const auto whole = make_whole({}, scan);
  ASSERT_GE(whole.size(), 3U);
  for (const auto& obstacle : whole) EXPECT_LE(obstacle.width_m, WholeOptions{}.max_width_m + 1e-9);
}

TEST(WholeObstacles, WithoutAScanAreAsTheyWere) {
  const auto whole = make_whole({obstacle_at(10.0, 0.05, 0.5)}, {});
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(whole[0].width_m, 0.5);
}

TEST(WholeObstacles, HaveFiniteBoxesBeforeACameraThatLooksDown) {
  StereoCamera camera;
  camera.fx_px = camera.fy_px = 700;
  camera.cx_px = camera.cx_right_px = 600;
  camera.cy_px = 180;
  camera.baseline_m = 0.5;
  camera.mount.height_m = 1.0;
  camera.mount.pitch_rad = radians(40.0);
  const Projection tilted(camera);
  Scan scan = open_scan();
  put(scan, 1.0, -0.1, 0.1);
  // As tall as the camera sees nobody: his head is behind the plane of the image.
  const auto whole = whole_obstacles(std::vector{obstacle_at(1.0, 0.0, 0.3, 3.0)}, scan, tilted, {}, {});
  ASSERT_EQ(whole.size(), 1U);
  const ImageBox& box = whole[0].box;
  EXPECT_TRUE(std::isfinite(box.v_px) && std::isfinite(box.height_px));
  EXPECT_LT(box.v_px, 0.0) << "the head is above the image, not mirrored below the feet";
  EXPECT_GT(box.v_px + box.height_px, 180.0);
}

}  // namespace
}  // namespace flies
