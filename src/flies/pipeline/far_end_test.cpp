#include "flies/pipeline/far_end.hpp"

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

TEST(FarEnd, WhatStandsBeyondIsDropped) {
  ConcentrateResult found;
  for (const double x_m : {3.0, 12.0, 8.0}) {
    found.obstacles.emplace_back();
    found.obstacles.back().x_m = x_m;
  }
  found.obstacle_of_fly = {0, 1, 2, -1, 1};
  drop_beyond(10.0, found);
  ASSERT_EQ(found.obstacles.size(), 2U);
  EXPECT_EQ(found.obstacles[1].x_m, 8.0);
  EXPECT_EQ(found.obstacle_of_fly, (std::vector<int>{0, -1, 1, -1, -1}));
}

}  // namespace
}  // namespace flies::detail
