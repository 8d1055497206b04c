#include "flies/pipeline/ghosts.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace flies::detail {
namespace {

TEST(FarEnd, FliesLiveBeyondItWhereRangesAreHardlyKnown) {
  StereoCamera camera;
  camera.fx_px = camera.fy_px = 424.0;
  camera.baseline_m = 0.05;  // 21.2 px m
  FieldOptions reported;
  reported.x_max_m = 10.6;                                      // 2 px
  EXPECT_NEAR(lived_in(reported, camera).x_max_m, 42.4, 1e-9);  // 0.5 px
  reported.x_max_m = 20.0;                                      // 1.06 px
  EXPECT_NEAR(lived_in(reported, camera).x_max_m, 84.8, 1e-9);  // 0.25 px, the least
  reported.x_max_m = 100.0;
  EXPECT_EQ(lived_in(reported, camera).x_max_m, 100.0);
  reported.x_max_m = 4.0;  // 5.3 px
  EXPECT_EQ(lived_in(reported, camera).x_max_m, 4.0);
}

TEST(FarEnd, FliesAreAsDenseInALongerField) {
  FieldOptions reported;
  reported.x_min_m = 2.0;
  reported.x_max_m = 8.0;
  EXPECT_EQ(flies_in(reported, reported, 4001), 4001);
  FieldOptions lived = reported;
  lived.x_max_m = 32.0;  // two octaves more on two
  EXPECT_EQ(flies_in(lived, reported, 4001), 8002);
  reported.x_max_m = 2.1;
  EXPECT_EQ(flies_in(lived, reported, 1000), 4000);
}

TEST(Drop, NumbersWhatIsLeftAnew) {
  ConcentrateResult found;
  for (const double x_m : {3.0, 12.0, 8.0}) {
    found.obstacles.emplace_back();
    found.obstacles.back().x_m = x_m;
  }
  found.obstacle_of_fly = {0, 1, 2, -1, 1};
  drop([](const Obstacle& obstacle) { return obstacle.x_m > 10.0; }, found);
  ASSERT_EQ(found.obstacles.size(), 2U);
  EXPECT_EQ(found.obstacles[1].x_m, 8.0);
  EXPECT_EQ(found.obstacle_of_fly, (std::vector<int>{0, -1, 1, -1, -1}));
}

TEST(IsSeenThrough, WhereTheGroundGoesOnFarBehindInAllDirections) {
  Scan scan;
  scan.angle_min_rad = -0.05;
  scan.angle_increment_rad = 0.01;
  scan.free_m.assign(11, 9.0);
  scan.states.assign(11, SectorState::free);
  Obstacle post;
  post.x_m = post.range_m = 2.0;
  post.width_m = 0.05;  // three sectors
  post.height_m = 1.5;
  EXPECT_TRUE(is_seen_through(post, scan));
  scan.free_m[6] = 2.1;
  EXPECT_FALSE(is_seen_through(post, scan));
  scan.free_m[6] = 9.0;
  scan.free_m[9] = 2.1;  // beside it
  EXPECT_TRUE(is_seen_through(post, scan));
  post.height_m = 0.6;  // legs of tables
  EXPECT_FALSE(is_seen_through(post, scan));
  post.height_m = 1.5;
  post.y_m = 0.11;  // at the end of what is scanned
  EXPECT_FALSE(is_seen_through(post, scan));
  EXPECT_FALSE(is_seen_through(post, {}));
}

}  // namespace
}  // namespace flies::detail
