#include "flies/eval/person_paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace flies {
namespace {

constexpr double kFirstThreshold = 0.1, kThreshold = 0.5;
constexpr double kExact = 1e-12;  // quotients of small whole numbers

/// A person 10 m straight ahead of a level camera 1.5 m above the ground, 1.7 m tall.
struct Scene {
  StereoCamera camera{.fx_px = 500,
                      .fy_px = 500,
                      .cx_px = 320,
                      .cx_right_px = 320,
                      .cy_px = 240,
                      .baseline_m = 0.5,
                      .width_px = 640,
                      .height_px = 480,
                      .mount = {.height_m = 1.5}};
  FrameTruth truth;
  Detection detection;
  std::vector<Pedestrian> reports;

  Scene() {
    LabelledObject person;
    person.type = "Pedestrian";
    person.footprint = {10.0, 0.0, 0.0, 0.5, 0.5};
    person.height_m = 1.7;
    person.box = {302.5, 230.0, 35.0, 85.0};
    truth.objects = {person};
  }
  void add_flies() {
    for (const float z_m : {0.8F, 1.0F, 1.2F}) detection.evolved.flies.push_back({10.0, 0.0, z_m}, 1.0F);
  }
  void add_obstacle() { detection.concentrate.obstacles.push_back({.x_m = 9.8, .range_m = 9.8, .box = {}}); }
  void add_box(double first_look, double aside_px = 0.0) {
    Roi roi;
    roi.person = truth.objects[0].box;
    roi.person.u_px += aside_px;
    detection.rois.push_back(roi);
    detection.roi_scores.push_back(first_look);
  }
  void report(double probability) {
    Pedestrian person;
    person.x_m = person.range_m = 10.0;
    person.probability = probability;
    person.box = truth.objects[0].box;
    reports.push_back(person);
  }
  PersonPath follow() const {
    return follow_people(truth, camera, detection, reports, kFirstThreshold, kThreshold).paths.at(0);
  }
};

TEST(FollowPeople, NamesTheStageThatLostThePerson) {
  Scene scene;
  EXPECT_EQ(scene.follow().stage, PersonStage::no_flies);
  scene.add_flies();
  EXPECT_EQ(scene.follow().stage, PersonStage::no_obstacle);
  scene.add_obstacle();
  EXPECT_EQ(scene.follow().stage, PersonStage::no_box);
  scene.add_box(0.9, 30.0);  // beside him
  EXPECT_EQ(scene.follow().stage, PersonStage::no_box);
  scene.add_box(0.05);
  EXPECT_EQ(scene.follow().stage, PersonStage::first_look);
  scene.add_box(0.2);
  EXPECT_EQ(scene.follow().stage, PersonStage::suppression);
  scene.report(0.4);
  EXPECT_EQ(scene.follow().stage, PersonStage::second_look);
  scene.report(0.6);
  EXPECT_EQ(scene.follow().stage, PersonStage::found);
}

TEST(FollowPeople, DoesNotAskWhereABoxCameFrom) {
  Scene scene;
  scene.add_box(0.05);
  EXPECT_EQ(scene.follow().stage, PersonStage::first_look);
}

TEST(FollowPeople, CountsFliesInTheBoxAndNear) {
  Scene scene;
  scene.add_flies();
  scene.detection.evolved.flies.push_back({10.0, 0.0, 1.0}, 0.0F);  // unfit
  scene.detection.evolved.flies.push_back({15.0, 0.0, 1.0}, 1.0F);  // behind
  scene.detection.evolved.flies.push_back({10.0, 0.6, 1.0}, 1.0F);  // beside
  EXPECT_EQ(scene.follow().flies, 3U);
}

TEST(FollowPeople, RanksTheSurestOfHisBoxes) {
  Scene scene;
  scene.add_box(0.9, 30.0);
  scene.add_box(0.8, 60.0);
  scene.add_box(0.5);
  scene.add_box(0.6, 2.0);
  EXPECT_EQ(scene.follow().rank, 2U);
  EXPECT_NEAR(scene.follow().best_overlap, 1.0, kExact);
}

TEST(FollowPeople, PassesOverThoseWhoNeedNotBeFound) {
  Scene scene;
  scene.truth.objects[0].type = "Cyclist";
  EXPECT_TRUE(follow_people(scene.truth, scene.camera, scene.detection, {}, 0.1, 0.5).paths.empty());
}

TEST(SumUp, CountsByStageAndByNumberOfBoxes) {
  const std::vector<PeopleTrail> trails = {
      {{{.object = 0, .stage = PersonStage::found, .rank = 2}, {.object = 1, .stage = PersonStage::no_box, .rank = {}}},
       100},
      {{{.object = 0, .stage = PersonStage::second_look, .rank = 29},
        {.object = 1, .stage = PersonStage::found, .rank = 30}},
       50},
      {{}, 0}};
  const PeopleLosses losses = sum_up(trails);
  EXPECT_EQ(losses.people[static_cast<std::size_t>(PersonStage::found)], 2);
  EXPECT_EQ(losses.people[static_cast<std::size_t>(PersonStage::no_box)], 1);
  EXPECT_EQ(losses.people[static_cast<std::size_t>(PersonStage::second_look)], 1);
  EXPECT_NEAR(losses.boxes_per_pair, 50.0, kExact);
  std::vector<double> recall;
  for (const auto& [boxes, share] : losses.recall) recall.push_back(share);
  EXPECT_THAT(recall, testing::ElementsAre(0.25, 0.25, 0.5, 0.75, 0.75, 0.75));
}

TEST(SumUp, HasNoRecallOfNobody) { EXPECT_TRUE(sum_up({}).recall.empty()); }

}  // namespace
}  // namespace flies
