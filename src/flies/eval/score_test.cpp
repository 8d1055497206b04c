#include "flies/eval/score.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace flies {
namespace {

constexpr double kExact = 1e-9;  // sums of a few doubles

Obstacle obstacle_at(double x_m, double y_m) {
  Obstacle obstacle;
  obstacle.x_m = x_m;
  obstacle.y_m = y_m;
  obstacle.range_m = std::hypot(x_m, y_m);
  return obstacle;
}

LabelledObject object_at(const std::string& type, double x_m, double y_m, double length_m, double width_m) {
  LabelledObject object;
  object.type = type;
  object.footprint = {x_m, y_m, 0.0, length_m, width_m};
  object.height_m = 1.6;
  return object;
}

/// A post: returns from 0.1 to 1.5 m above the road.
void add_post(FrameTruth& truth, double x_m, double y_m) {
  for (int i = 1; i <= 15; ++i) truth.lidar.push_back({{x_m, y_m, 0.1 * i}, 0.1 * i});
}

TEST(ScoreFrame, AsksForThreeLidarReturnsBetweenKerbAndLorryHeight) {
  FrameTruth truth;
  truth.lidar = {{{10, 0, 0.5}, 0.5}, {{10, 0, 1.0}, 1.0}, {{10, 0, 0.2}, 0.2}, {{10, 0, 3.0}, 3.0}};
  EXPECT_FALSE(score_frame(truth, std::vector{obstacle_at(10, 0)}).obstacles[0].right);
  truth.lidar.push_back({{10, 0, 1.5}, 1.5});
  EXPECT_TRUE(score_frame(truth, std::vector{obstacle_at(10, 0)}).obstacles[0].right);
}

TEST(ScoreFrame, WidensTheRadiusWithTheObstaclesRange) {
  FrameTruth truth;
  add_post(truth, 20, 0);
  // 0.75 m + 5 % of 21.8 m = 1.84 m; at 21.9 m, 1.845 m.
  EXPECT_TRUE(score_frame(truth, std::vector{obstacle_at(21.8, 0)}).obstacles[0].right);
  EXPECT_FALSE(score_frame(truth, std::vector{obstacle_at(21.9, 0)}).obstacles[0].right);
}

TEST(ScoreFrame, JudgesByLabelsWithoutLidar) {
  FrameTruth truth;
  truth.objects = {object_at("Car", 12, 0, 4, 2)};
  const auto score = score_frame(truth, std::vector{obstacle_at(10, 0), obstacle_at(30, 0)});
  EXPECT_TRUE(score.obstacles[0].right);
  EXPECT_FALSE(score.obstacles[1].right);
}

TEST(ScoreFrame, CountsOnlyVisibleObjectsInRange) {
  FrameTruth truth;
  truth.objects = {object_at("Car", 4, 0, 4, 2), object_at("Car", 20, 0, 4, 2), object_at("Car", 43, 0, 4, 2),
                   object_at("Car", 20, 9, 4, 2)};
  truth.objects[3].visible = false;
  const auto score = score_frame(truth, {});
  EXPECT_FALSE(score.objects[0].counted);  // near face at 2 m
  EXPECT_TRUE(score.objects[1].counted);
  EXPECT_FALSE(score.objects[2].counted);  // near face at 41 m
  EXPECT_FALSE(score.objects[3].counted);
}

TEST(ScoreFrame, ReportsAnObstacleForTheNearestFootprintOnly) {
  FrameTruth truth;
  truth.objects = {object_at("Car", 12, 0, 4, 2), object_at("Pedestrian", 10, 1.9, 0.5, 0.5)};
  const auto score = score_frame(truth, std::vector{obstacle_at(10, 1.5), obstacle_at(10.5, 0), obstacle_at(11, 0)});
  EXPECT_EQ(score.obstacles[0].object, 1);
  EXPECT_EQ(score.objects[0].reports, 2);
  EXPECT_EQ(score.objects[1].reports, 1);
}

TEST(ScoreFrame, MeasuresTheNearFaceInTheBoxWithoutLidar) {
  FrameTruth truth;
  truth.objects = {object_at("Car", 12, 0, 4, 2)};
  auto obstacle = obstacle_at(10.5, 0);
  obstacle.width_m = 2.5;
  obstacle.height_m = 1.5;
  const auto verdict = score_frame(truth, std::vector{obstacle}).obstacles[0];
  EXPECT_NEAR(verdict.near_range_m, 10.0, kExact);
  EXPECT_NEAR(verdict.range_error_m, 0.5, kExact);
  EXPECT_NEAR(verdict.width_error_m, 0.5, kExact);
  EXPECT_NEAR(verdict.height_error_m, -0.1, kExact);
}

TEST(ScoreFrame, PrefersTheFaceThatTheLidarSawInTheObstaclesDirection) {
  FrameTruth truth;
  truth.objects = {object_at("Car", 12, 0, 4, 2)};
  add_post(truth, 10.4, 0.0);
  add_post(truth, 11.0, 0.8);  // elsewhere on the car, not in this direction
  const auto score = score_frame(truth, std::vector{obstacle_at(10.5, 0), obstacle_at(11.2, 0.8)});
  EXPECT_NEAR(score.obstacles[0].near_range_m, 10.4, kExact);
  EXPECT_NEAR(score.obstacles[1].near_range_m, std::hypot(11.0, 0.8), kExact);
}

TEST(AsObstacles, KeepsPlaceAndHeight) {
  Pedestrian person;
  person.x_m = 3.0;
  person.y_m = 4.0;
  person.range_m = 5.0;
  person.height_m = 1.7;
  const auto obstacles = as_obstacles(std::vector{person});
  ASSERT_EQ(obstacles.size(), 1u);
  EXPECT_EQ(obstacles[0].range_m, 5.0);
  EXPECT_EQ(obstacles[0].height_m, 1.7);
}

}  // namespace
}  // namespace flies
