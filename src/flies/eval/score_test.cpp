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

TEST(Summarize, AddsUpAHandMadeCase) {
  std::vector<FrameTruth> truths(2);
  truths[0].frame = 0;
  truths[0].objects = {object_at("Car", 12, 0, 4, 2), object_at("Pedestrian", 8, 4, 0.5, 0.5)};
  add_post(truths[0], 10, 0);
  add_post(truths[0], 30, -5);  // an unlabelled pole: right to report, nothing to find
  truths[1].frame = 1;
  truths[1].objects = {object_at("Car", 12, 0, 4, 2), object_at("Cyclist", 25.25, 0, 0.5, 0.5)};
  add_post(truths[1], 10, 0);
  add_post(truths[1], 25, 0);
  const std::vector<std::vector<Obstacle>> obstacles = {
      {obstacle_at(10.5, 0), obstacle_at(10.1, 0), obstacle_at(30, -5), obstacle_at(20, 10)},
      {obstacle_at(10.2, 0), obstacle_at(25.5, 0)}};
  std::vector<FrameScore> scores;
  for (std::size_t i = 0; i < 2; ++i) scores.push_back(score_frame(truths[i], obstacles[i]));

  const Measures measures = summarize(truths, scores);
  EXPECT_EQ(measures.precision.hits, 5);
  EXPECT_EQ(measures.precision.total, 6);
  EXPECT_EQ(measures.label_precision.total, 0);
  EXPECT_EQ(measures.recall.hits, 3);
  EXPECT_EQ(measures.recall.total, 4);
  EXPECT_EQ(measures.people_recall.hits, 1);
  EXPECT_EQ(measures.people_recall.total, 2);
  ASSERT_EQ(measures.recall_by_class.size(), 3u);
  EXPECT_EQ(measures.recall_by_class[0].name, "Car");
  EXPECT_EQ(measures.recall_by_class[0].recall.hits, 2);
  ASSERT_EQ(measures.recall_by_range.size(), 4u);
  EXPECT_EQ(measures.recall_by_range[0].recall.total, 1);  // the pedestrian at 8.6 m
  EXPECT_EQ(measures.recall_by_range[1].recall.hits, 2);
  EXPECT_EQ(measures.recall_by_range[2].recall.hits, 1);
  EXPECT_NEAR(measures.obstacles_per_frame, 3.0, kExact);
  EXPECT_NEAR(measures.reports_per_found_object, 4.0 / 3.0, kExact);
  ASSERT_TRUE(measures.range_error.has_value());
  EXPECT_NEAR(*measures.range_error, 0.02, kExact);  // of 5 %, 1 %, 2 % and 2 %
  EXPECT_NEAR(*measures.absolute_range_error, 0.02, kExact);
  ASSERT_EQ(measures.missed.size(), 1u);
  EXPECT_EQ(measures.missed[0].frame, 0);
  EXPECT_EQ(measures.missed[0].object.type, "Pedestrian");
}

TEST(Summarize, LeavesMediansEmptyWhenNothingWasReported) {
  std::vector<FrameTruth> truths(1);
  truths[0].objects = {object_at("Car", 12, 0, 4, 2)};
  const Measures measures = summarize(truths, std::vector{score_frame(truths[0], {})});
  EXPECT_FALSE(measures.range_error.has_value());
  EXPECT_FALSE(measures.precision.value().has_value());
  EXPECT_EQ(measures.recall.value(), 0.0);
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
