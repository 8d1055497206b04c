#include "flies/eval/scan_truth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "flies/eval/bearings.hpp"

namespace flies {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kExact = 1e-9;

StereoCamera camera() {
  StereoCamera c;
  c.fx_px = c.fy_px = 700;
  c.cx_px = c.cx_right_px = 600;
  c.cy_px = 180;
  c.baseline_m = 0.5;
  c.width_px = 1200;
  c.height_px = 370;
  return c;
}

/// Points at one height over the road in the middle of a sector, 1 cm one behind the other.
void add(std::vector<LidarPoint>& points, double angle_rad, double range_m, double above_road_m, int count) {
  for (int i = 0; i < count; ++i) {
    const double r = range_m + 0.01 * i;
    points.push_back({{r * std::cos(angle_rad), r * std::sin(angle_rad), above_road_m}, above_road_m});
  }
}

std::size_t sector_at(const ScanTruth& scan, double angle_deg) {
  return scan.bearings.sector_of(angle_deg * kDegree).value();
}

TEST(Bearings, CoverWhatBothCamerasSee) {
  const Bearings bearings = common_view(camera(), 0.5 * kDegree);
  const double left_rad = std::atan((600 - 700 * 0.5 / 45) / 700), right_rad = -std::atan(599.0 / 700);
  EXPECT_GE(bearings.angle_min_rad - 0.25 * kDegree, right_rad - kExact);
  EXPECT_LT(bearings.angle_min_rad - 0.75 * kDegree, right_rad);
  const double end_rad = bearings.angle_rad(bearings.count) - 0.25 * kDegree;
  EXPECT_LE(end_rad, left_rad + kExact);
  EXPECT_GT(end_rad + 0.5 * kDegree, left_rad);
}

TEST(Bearings, KnowTheSectorOfADirection) {
  const Bearings bearings{-1.0, 0.5, 4};  // from -1.25 to 0.75
  EXPECT_EQ(bearings.sector_of(-1.2), 0u);
  EXPECT_EQ(bearings.sector_of(-0.8), 0u);
  EXPECT_EQ(bearings.sector_of(-0.7), 1u);
  EXPECT_EQ(bearings.sector_of(0.7), 3u);
  EXPECT_FALSE(bearings.sector_of(0.8).has_value());
  EXPECT_FALSE(bearings.sector_of(-1.3).has_value());
  EXPECT_FALSE(bearings.sector_of(std::nan("")).has_value());
}

TEST(SharedRange, IsTheNearestThatEnoughShare) {
  const std::vector<double> ranges_m = {4.0, 10.0, 10.1, 10.2, 20.0, 20.0, 20.0, 20.0};
  EXPECT_EQ(shared_range_m(ranges_m, 3, 0.3, 0.0, 0.0), 10.0);
  EXPECT_EQ(shared_range_m(ranges_m, 3, 0.3, 0.0, 0.5), 10.1);
  EXPECT_EQ(shared_range_m(ranges_m, 3, 0.1, 0.0, 0.0), 20.0);
  EXPECT_EQ(shared_range_m(ranges_m, 3, 0.1, 0.02, 0.0), 10.0);  // 0.1 m + 2 %
  EXPECT_EQ(shared_range_m(ranges_m, 1, 0.1, 0.0, 0.0), 4.0);
  EXPECT_FALSE(shared_range_m(ranges_m, 5, 0.3, 0.0, 0.0).has_value());
  EXPECT_FALSE(shared_range_m({}, 1, 0.3, 0.0, 0.0).has_value());
}

TEST(ScanTruth, IsEmptyWithoutLidarAndMap) { EXPECT_TRUE(scan_truth({}, camera()).kinds.empty()); }

TEST(ScanTruth, TakesTheNearestRangeThatTwoReturnsShare) {
  FrameTruth truth;
  add(truth.lidar, 0.25 * kDegree, 8.0, 1.0, 1);   // a single one is dust
  add(truth.lidar, 0.25 * kDegree, 12.0, 1.0, 3);  // this is it
  add(truth.lidar, 0.25 * kDegree, 20.0, 1.0, 9);
  const ScanTruth scan = scan_truth(truth, camera());
  const std::size_t sector = sector_at(scan, 0.25);
  EXPECT_NEAR(scan.ranges_m[sector], 12.0, kExact);
  EXPECT_EQ(scan.kinds[sector], TrueSector::counted);
}

TEST(ScanTruth, LeavesOutWhatDoesNotStandOnTheRoad) {
  FrameTruth truth;
  add(truth.lidar, 0.25 * kDegree, 8.0, 0.2, 9);  // a kerb
  add(truth.lidar, 0.25 * kDegree, 9.0, 2.6, 9);  // a branch
  add(truth.lidar, 0.25 * kDegree, 25.0, 0.5, 9);
  const ScanTruth scan = scan_truth(truth, camera());
  EXPECT_NEAR(scan.ranges_m[sector_at(scan, 0.25)], 25.0, kExact);
}

TEST(ScanTruth, TellsOpenSectorsFromThoseItDoesNotCover) {
  FrameTruth truth;
  add(truth.lidar, 0.25 * kDegree, 8.0, 0.0, 4);   // road
  add(truth.lidar, 1.25 * kDegree, 8.0, 0.0, 3);   // too little of it
  add(truth.lidar, 2.25 * kDegree, 45.0, 1.0, 9);  // something beyond 40 m
  const ScanTruth scan = scan_truth(truth, camera());
  EXPECT_EQ(scan.kinds[sector_at(scan, 0.25)], TrueSector::open);
  EXPECT_EQ(scan.kinds[sector_at(scan, 1.25)], TrueSector::ignored);
  EXPECT_TRUE(std::isnan(scan.ranges_m[sector_at(scan, 1.25)]));
  EXPECT_EQ(scan.kinds[sector_at(scan, 2.25)], TrueSector::open);
}

TEST(ScanTruth, CountsOnlyWhatIsInRangeAndInViewOfBoth) {
  FrameTruth truth;
  add(truth.lidar, 0.25 * kDegree, 3.5, 1.0, 9);    // too near
  add(truth.lidar, 1.25 * kDegree, 35.0, 1.0, 9);   // neither to be found nor open
  add(truth.lidar, 38.75 * kDegree, 6.0, 1.0, 9);   // left of the right image
  add(truth.lidar, 37.75 * kDegree, 25.0, 1.0, 9);  // farther things there are seen by both
  add(truth.lidar, 10.25 * kDegree, 6.0, 1.0, 9);
  const ScanTruth scan = scan_truth(truth, camera());
  for (const double ignored_deg : {0.25, 1.25, 38.75})
    EXPECT_EQ(scan.kinds[sector_at(scan, ignored_deg)], TrueSector::ignored) << ignored_deg;
  for (const double counted_deg : {37.75, 10.25})
    EXPECT_EQ(scan.kinds[sector_at(scan, counted_deg)], TrueSector::counted) << counted_deg;
}

TEST(ScanTruth, PrefersTheMapAndAsksForMoreOfItsPoints) {
  FrameTruth truth;
  add(truth.lidar, 0.25 * kDegree, 6.0, 1.0, 9);
  add(truth.map, 0.25 * kDegree, 8.0, 1.0, 7);
  add(truth.map, 0.25 * kDegree, 15.0, 1.0, 9);
  const ScanTruth scan = scan_truth(truth, camera());
  EXPECT_NEAR(scan.ranges_m[sector_at(scan, 0.25)], 15.01, kExact);  // the second of the eight
}

}  // namespace
}  // namespace flies
