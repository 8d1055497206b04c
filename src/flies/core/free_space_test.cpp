#include "flies/core/free_space.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace flies {
namespace {

constexpr double kRounding = 1e-12;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Sectors of 0.1 rad, the first one 0.2 rad to the right; obstacles stand where the free ground ends.
Scan scan_of(const std::vector<double>& free_m, const std::vector<SectorState>& states) {
  Scan scan;
  scan.angle_min_rad = -0.2;
  scan.angle_increment_rad = 0.1;
  scan.free_m = free_m;
  scan.ranges_m = free_m;
  scan.confidence.assign(states.size(), 1.0);
  scan.states = states;
  return scan;
}

constexpr auto kFree = SectorState::free;
constexpr auto kObstacle = SectorState::obstacle;
constexpr auto kUnknown = SectorState::unknown;

TEST(FreeSpace, HasTheOriginAndTwoEdgesASector) {
  const auto polygon = free_space(scan_of({10, 20}, {kObstacle, kFree}));
  ASSERT_EQ(polygon.size(), 5u);
  EXPECT_EQ(polygon[0].x_m, 0.0);
  EXPECT_EQ(polygon[0].y_m, 0.0);
  const double angles_rad[] = {-0.25, -0.15, -0.15, -0.05};
  for (std::size_t i = 1; i < polygon.size(); ++i) {
    EXPECT_NEAR(std::hypot(polygon[i].x_m, polygon[i].y_m), i < 3 ? 10.0 : 20.0, kRounding) << i;
    EXPECT_NEAR(std::atan2(polygon[i].y_m, polygon[i].x_m), angles_rad[i - 1], kRounding) << i;
  }
}

TEST(FreeSpace, GoesBackToTheOriginWhereNothingIsKnown) {
  // Ground in front of what is not known is not promised to be free.
  const auto polygon = free_space(scan_of({0, 10, 8, 0, 10, kNan}, {kFree, kFree, kUnknown, kObstacle, kFree, kFree}));
  ASSERT_EQ(polygon.size(), 6u);
  EXPECT_EQ(polygon[3].x_m, 0.0);
  EXPECT_EQ(polygon[3].y_m, 0.0);
  EXPECT_GT(polygon[5].x_m, 9.0);
}

TEST(FreeSpace, OfNothingSeenFreeIsEmpty) {
  EXPECT_TRUE(free_space({}).empty());
  EXPECT_TRUE(free_space(scan_of({0, 10, kNan}, {kFree, kUnknown, kObstacle})).empty());
}

TEST(SectorAt, IsTheOneWhoseMiddleIsNearest) {
  const Scan scan = scan_of({1, 1, 1}, {kFree, kFree, kFree});
  EXPECT_EQ(sector_at(scan, -0.2), 0u);
  EXPECT_EQ(sector_at(scan, -0.24), 0u);
  EXPECT_EQ(sector_at(scan, -0.14), 1u);
  EXPECT_EQ(sector_at(scan, 0.04), 2u);
  EXPECT_FALSE(sector_at(scan, -0.26));
  EXPECT_FALSE(sector_at(scan, 0.06));
  EXPECT_FALSE(sector_at(scan, kNan));
  EXPECT_FALSE(sector_at({}, 0.0)) << "a scan without sectors has no width of one either";
}

}  // namespace
}  // namespace flies
