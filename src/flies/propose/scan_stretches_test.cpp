#include "flies/propose/scan_stretches.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace flies {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr double kIncrement_rad = 0.01;

/// 101 sectors from -0.5 to 0.5 rad, all free.
Scan free_scan() {
  Scan scan;
  scan.angle_min_rad = -0.5;
  scan.angle_increment_rad = kIncrement_rad;
  scan.ranges_m.assign(101, std::numeric_limits<double>::quiet_NaN());
  scan.free_m.assign(101, 30.0);
  scan.confidence.assign(101, 1.0);
  scan.states.assign(101, SectorState::free);
  return scan;
}

void put_surface(Scan& scan, std::size_t first, std::size_t last, double range_m) {
  for (std::size_t i = first; i <= last; ++i) {
    scan.ranges_m[i] = range_m;
    scan.states[i] = SectorState::obstacle;
  }
}

Obstacle obstacle_at(double range_m, double azimuth_rad, double width_m) {
  Obstacle obstacle;
  obstacle.range_m = range_m;
  obstacle.x_m = range_m * std::cos(azimuth_rad);
  obstacle.y_m = range_m * std::sin(azimuth_rad);
  obstacle.width_m = width_m;
  obstacle.height_m = 1.6;
  return obstacle;
}

TEST(ScanStretches, AreNoneWithoutAScan) { EXPECT_THAT(scan_stretches({}, {}, {}, {}), IsEmpty()); }

TEST(ScanStretches, AreWhereNoObstacleIs) {
  Scan scan = free_scan();
  put_surface(scan, 68, 72, 10.0);  // middle 0.2 rad
  const auto stretches = scan_stretches({}, scan, {}, {});
  ASSERT_THAT(stretches, SizeIs(1));
  EXPECT_NEAR(stretches[0].range_m, 10.0, 1e-9);
  EXPECT_NEAR(std::atan2(stretches[0].y_m, stretches[0].x_m), 0.2, 1e-9);
  EXPECT_NEAR(stretches[0].width_m, 0.5, 1e-9);
}

TEST(ScanStretches, LeaveOutWhatAnObstacleCovers) {
  Scan scan = free_scan();
  put_surface(scan, 68, 72, 10.0);
  EXPECT_THAT(scan_stretches(std::vector{obstacle_at(10.3, 0.2, 0.5)}, scan, {}, {}), IsEmpty());
  EXPECT_THAT(scan_stretches(std::vector{obstacle_at(14.0, 0.2, 0.5)}, scan, {}, {}), SizeIs(1));   // behind it
  EXPECT_THAT(scan_stretches(std::vector{obstacle_at(10.3, -0.2, 0.5)}, scan, {}, {}), SizeIs(1));  // beside it
  Obstacle kerb = obstacle_at(10.3, 0.2, 0.5);
  kerb.height_m = 0.2;  // too low for boxes
  EXPECT_THAT(scan_stretches(std::vector{kerb}, scan, {}, {}), SizeIs(1));
}

TEST(ScanStretches, AreTheEndsOfAWideObstacle) {
  Scan scan = free_scan();
  put_surface(scan, 30, 70, 10.0);  // 4.1 m, of which boxes cover one to each side of the middle
  const auto stretches = scan_stretches(std::vector{obstacle_at(10.0, 0.0, 4.1)}, scan, {}, {});
  ASSERT_THAT(stretches, SizeIs(2));
  for (const Obstacle& stretch : stretches) {
    EXPECT_NEAR(stretch.width_m, 1.05, 0.06);
    EXPECT_NEAR(std::abs(stretch.y_m), 1.5, 0.1);
  }
}

TEST(ScanStretches, AreAsWideAsBoxesReach) {
  Scan scan = free_scan();
  put_surface(scan, 20, 80, 10.0);  // 6.1 m
  const auto stretches = scan_stretches({}, scan, {}, {});
  ASSERT_THAT(stretches, SizeIs(4));
  for (const Obstacle& stretch : stretches) EXPECT_LE(stretch.width_m, 1.6 + 1e-9);
}

TEST(ScanStretches, EndWhereTheRangeSteps) {
  Scan scan = free_scan();
  put_surface(scan, 45, 50, 10.0);
  put_surface(scan, 51, 55, 12.0);
  const auto stretches = scan_stretches({}, scan, {}, {});
  ASSERT_THAT(stretches, SizeIs(2));
  EXPECT_NEAR(stretches[0].range_m, 10.0, 1e-9);
  EXPECT_NEAR(stretches[1].range_m, 12.0, 1e-9);
}

TEST(ScanStretches, AreNotNarrowerThanAsked) {
  Scan scan = free_scan();
  put_surface(scan, 50, 50, 10.0);  // 0.1 m
  EXPECT_THAT(scan_stretches({}, scan, {}, {}), IsEmpty());
  ProposeOptions options;
  options.min_stretch_m = 0.05;
  EXPECT_THAT(scan_stretches({}, scan, {}, options), SizeIs(1));
}

}  // namespace
}  // namespace flies
