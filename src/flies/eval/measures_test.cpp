#include "flies/eval/measures.hpp"

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
  EXPECT_EQ(measures.all.precision.hits, 5);
  EXPECT_EQ(measures.all.precision.total, 6);
  EXPECT_EQ(measures.all.label_precision.total, 0);
  EXPECT_EQ(measures.all.recall.hits, 3);
  EXPECT_EQ(measures.all.recall.total, 4);
  EXPECT_EQ(measures.people_recall.hits, 1);
  EXPECT_EQ(measures.people_recall.total, 2);
  ASSERT_EQ(measures.by_class.size(), 3u);
  EXPECT_EQ(measures.by_class[0].name, "Car");
  EXPECT_EQ(measures.by_class[0].accuracy.recall.hits, 2);
  ASSERT_EQ(measures.by_range.size(), 4u);
  EXPECT_EQ(measures.by_range[0].accuracy.recall.total, 1);  // the pedestrian at 8.6 m
  EXPECT_EQ(measures.by_range[1].accuracy.recall.hits, 2);
  EXPECT_EQ(measures.by_range[2].accuracy.recall.hits, 1);
  EXPECT_NEAR(measures.obstacles_per_frame, 3.0, kExact);
  EXPECT_NEAR(measures.reports_per_found_object, 4.0 / 3.0, kExact);
  ASSERT_TRUE(measures.all.range_error.has_value());
  EXPECT_NEAR(*measures.all.range_error, 0.02, kExact);  // of 5 %, 1 %, 2 % and 2 %
  EXPECT_NEAR(*measures.all.absolute_range_error, 0.02, kExact);
  ASSERT_EQ(measures.missed.size(), 1u);
  EXPECT_EQ(measures.missed[0].frame, 0);
  EXPECT_EQ(measures.missed[0].object.type, "Pedestrian");
}

TEST(Summarize, MeasuresWidthsOfWhatIsSeenWhole) {
  std::vector<FrameTruth> truths(1);
  // The seen width of each is 2 m; the last two cannot show it all, and a tram is no car.
  truths[0].objects = {object_at("Car", 12, 0, 0, 2), object_at("Van", 20, 8, 0, 2), object_at("Tram", 20, -8, 0, 2),
                       object_at("Car", 30, 12, 0, 2), object_at("Car", 30, -12, 0, 2)};
  truths[0].objects[1].footprint.yaw_rad = std::atan2(8, 20);
  truths[0].objects[3].occlusion = 1;
  truths[0].objects[4].in_view_fraction = 0.6;
  std::vector<Obstacle> obstacles = {obstacle_at(12, 0), obstacle_at(20, 8), obstacle_at(20, -8), obstacle_at(30, 12),
                                     obstacle_at(30, -12)};
  const double widths_m[] = {1.5, 2.1, 9.0, 9.0, 9.0};
  for (std::size_t i = 0; i < obstacles.size(); ++i) obstacles[i].width_m = widths_m[i];
  const Measures measures = summarize(truths, std::vector{score_frame(truths[0], obstacles)});
  ASSERT_TRUE(measures.whole_width_error_m.has_value());
  EXPECT_NEAR(*measures.whole_width_error_m, 0.3, kExact);  // of 0.5 and 0.1
}

TEST(Summarize, MeasuresDepthsOfWhatIsSeenWhole) {
  std::vector<FrameTruth> truths(1);
  truths[0].objects = {object_at("Car", 12, 0, 4, 2), object_at("Tram", 30, 0, 4, 2)};  // their backs alone are seen
  std::vector<Obstacle> obstacles = {obstacle_at(12, 0), obstacle_at(30, 0)};
  obstacles[0].depth_m = 0.5;
  obstacles[1].depth_m = 0.7;
  const Measures measures = summarize(truths, std::vector{score_frame(truths[0], obstacles)});
  ASSERT_TRUE(measures.whole_depth_error_m && measures.all.depth_error_m);
  EXPECT_NEAR(*measures.whole_depth_error_m, 0.5, kExact);
  EXPECT_NEAR(*measures.all.depth_error_m, 0.6, kExact);
}

TEST(Summarize, LeavesMediansEmptyWhenNothingWasReported) {
  std::vector<FrameTruth> truths(1);
  truths[0].objects = {object_at("Car", 12, 0, 4, 2)};
  const Measures measures = summarize(truths, std::vector{score_frame(truths[0], {})});
  EXPECT_FALSE(measures.all.range_error.has_value());
  EXPECT_FALSE(measures.all.precision.value().has_value());
  EXPECT_EQ(measures.all.recall.value(), 0.0);
}

}  // namespace
}  // namespace flies
