#include "flies/eval/evaluation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace flies {
namespace {

using Group = MeasureKey::Group;

constexpr double kExact = 1e-9;  // sums of a few doubles

Obstacle obstacle_at(double x_m, double y_m) {
  Obstacle obstacle;
  obstacle.x_m = x_m;
  obstacle.y_m = y_m;
  obstacle.range_m = std::hypot(x_m, y_m);
  return obstacle;
}

/// Pairs without texture, a car 10 m ahead in each and a person 8 m ahead in the last.
Dataset made_up_dataset(std::size_t pairs) {
  Dataset dataset;
  for (std::size_t i = 0; i < pairs; ++i)
    dataset.pairs.push_back({"l/" + std::to_string(i) + ".png", "r/" + std::to_string(i) + ".png"});
  dataset.load = [pairs](std::size_t i) {
    TruthFrame frame;
    frame.camera = {.fx_px = 60,
                    .fy_px = 60,
                    .cx_px = 40,
                    .cx_right_px = 40,
                    .cy_px = 30,
                    .baseline_m = 0.5,
                    .width_px = 80,
                    .height_px = 60,
                    .mount = {}};
    const GrayImage flat{80, 60, std::vector<std::uint8_t>(4800, 90)};
    frame.images = {flat, flat};
    frame.truth.frame = static_cast<int>(i);
    frame.truth.name = std::to_string(i);
    frame.truth.objects.push_back({"Car", 0, {12, 0, 0, 4, 2}});
    if (i + 1 == pairs) frame.truth.objects.push_back({"Pedestrian", 1, {8, 4, 0, 0.5, 0.5}});
    return frame;
  };
  return dataset;
}

Findings findings(std::vector<Obstacle> obstacles, double time_ms, double evaluations) {
  return {std::move(obstacles), time_ms, evaluations, {}};
}

TEST(Evaluate, MeasuresEveryRunOfEveryMethod) {
  const Dataset dataset = made_up_dataset(3);
  const std::vector<std::size_t> frames = {0, 1, 2};
  const Method sure{"sure", {[](std::size_t, const TruthFrame&) {
                      return findings({obstacle_at(10, 0), obstacle_at(8, 4)}, 10, 100);
                    }}};
  const Method unsure{"unsure",
                      {[](std::size_t, const TruthFrame&) { return findings({obstacle_at(10, 0)}, 1, 10); },
                       [](std::size_t pair, const TruthFrame&) {
                         return pair == 1 ? findings({}, 3, 20) : findings({obstacle_at(10, 0)}, 3, 20);
                       }}};
  std::vector<std::size_t> progress;
  const Evaluation evaluation =
      evaluate(dataset, frames, {sure, unsure}, {}, [&](std::size_t done) { progress.push_back(done); });

  EXPECT_EQ(progress, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(evaluation.frames, 3u);
  EXPECT_EQ(evaluation.frames_with_lidar, 0u);
  EXPECT_EQ(evaluation.objects, 4);
  ASSERT_EQ(evaluation.by_class.size(), 2u);
  EXPECT_EQ(evaluation.by_class[0].part, "Car");
  EXPECT_EQ(evaluation.by_class[0].objects, 3);
  ASSERT_EQ(evaluation.by_range.size(), 4u);
  EXPECT_EQ(evaluation.by_range[0].part, "5-10 m");
  EXPECT_EQ(evaluation.by_range[0].objects, 1);

  ASSERT_EQ(evaluation.methods.size(), 2u);
  const auto& first = evaluation.methods[0];
  EXPECT_EQ(first.name, "sure");
  EXPECT_EQ(first.runs, 1);
  EXPECT_NEAR(first.estimates.at({Group::all, "", "recall"}).median, 1.0, kExact);
  EXPECT_NEAR(first.estimates.at({Group::all, "", "label_precision"}).median, 4.0 / 6.0, kExact);
  EXPECT_EQ(first.time_ms, 10.0);
  EXPECT_TRUE(first.missed.empty());

  const auto& second = evaluation.methods[1];
  EXPECT_EQ(second.runs, 2);
  EXPECT_NEAR(second.estimates.at({Group::all, "", "recall"}).median, 2.5 / 4.0, kExact);
  EXPECT_NEAR(second.estimates.at({Group::all, "", "recall"}).spread, 0.25, kExact);
  EXPECT_EQ(second.time_ms, 2.0);
  EXPECT_EQ(second.evaluations, 15.0);
  ASSERT_EQ(second.missed.size(), 2u);
  EXPECT_EQ(second.missed[0].frame_name, "1");
  EXPECT_EQ(second.missed[0].object.type, "Car");
  EXPECT_EQ(second.missed[0].runs, 1);
  EXPECT_EQ(second.missed[1].object.type, "Pedestrian");
  EXPECT_EQ(second.missed[1].runs, 2);
}

TEST(Evaluate, GivesReportsTheIndexOfThePairInTheWholeFolder) {
  const Dataset dataset = made_up_dataset(4);
  std::vector<ReportedFrame> reported(4);
  reported[3].obstacles = {obstacle_at(10, 0), obstacle_at(8, 4)};
  const std::vector<std::size_t> only_last = {3};
  const Evaluation evaluation = evaluate(dataset, only_last, {reported_method("reported", {reported})});
  EXPECT_NEAR(evaluation.methods[0].estimates.at({Group::all, "", "recall"}).median, 1.0, kExact);
  EXPECT_FALSE(evaluation.methods[0].time_ms.has_value());
}

/// Says the same in every direction.
Scan scan_of(SectorState state, double range_m, double confidence) {
  constexpr std::size_t kSectors = 20;
  return {-0.5,
          0.05,
          std::vector(kSectors, range_m),
          std::vector(kSectors, 0.0),
          std::vector(kSectors, confidence),
          std::vector(kSectors, state)};
}

TEST(Evaluate, MeasuresScansWhereThereIsTruth) {
  Dataset dataset = made_up_dataset(2);
  dataset.load = [load = dataset.load](std::size_t i) {
    TruthFrame frame = load(i);
    for (int k = 0; k < 8; ++k) frame.truth.lidar.push_back({{10.0, 0.01, 1.0}, 1.0});  // a post in one sector
    return frame;
  };
  const auto method = [](const std::string& name, std::vector<Scan> scans) {
    std::vector<std::vector<ReportedFrame>> runs;
    for (const auto& scan : scans) {
      runs.emplace_back(2);
      for (auto& frame : runs.back()) frame.scan = scan;
    }
    return reported_method(name, std::move(runs));
  };
  std::vector<ReportedFrame> only_one(2);
  only_one[0].scan = scan_of(SectorState::obstacle, 10.0, 0.55);
  const std::vector<std::size_t> frames = {0, 1};
  const Evaluation evaluation =
      evaluate(dataset, frames,
               {method("sure", {scan_of(SectorState::obstacle, 10.5, 0.55)}),
                method("unsure", {scan_of(SectorState::obstacle, 10.5, 0.55), scan_of(SectorState::unknown, 0.0, 0.0)}),
                reported_method("some", {only_one}), reported_method("none", {std::vector<ReportedFrame>(2)})});
  EXPECT_EQ(evaluation.sectors.sectors, 2);
  EXPECT_EQ(evaluation.sectors.near_sectors, 2);
  const auto value = [&](std::size_t m, const char* name) {
    return evaluation.methods[m].scan.value().estimates.at({Group::all, "", name}).median;
  };
  EXPECT_NEAR(value(0, "right"), 1.0, kExact);
  EXPECT_NEAR(value(0, "absolute_range_error"), 10.5 / std::hypot(10.0, 0.01) - 1.0, kExact);
  EXPECT_NEAR(value(1, "right"), 0.5, kExact);
  EXPECT_NEAR(value(1, "unknown"), 0.5, kExact);
  EXPECT_FALSE(evaluation.methods[2].scan.has_value());
  EXPECT_FALSE(evaluation.methods[3].scan.has_value());
  // Obstacles of confidence 0.55 are there up to the setting 0.5 and gone from 0.6 on.
  const auto& curve = evaluation.methods[0].scan.value().curve;
  ASSERT_GE(curve.size(), 2U);
  for (const auto& [setting, values] : curve)
    EXPECT_NEAR(values.at({Group::all, "", "blind"}), setting < 0.55 ? 0.0 : 1.0, kExact) << setting;
  EXPECT_EQ(evaluation.methods[0].scan.value().setting, "min_confidence");
}

TEST(Evaluate, JudgesNoScanWithoutTruthForIt) {
  const Dataset dataset = made_up_dataset(1);
  std::vector<ReportedFrame> reported(1);
  reported[0].scan = scan_of(SectorState::obstacle, 10.0, 1.0);
  const std::vector<std::size_t> frames = {0};
  EXPECT_FALSE(evaluate(dataset, frames, {reported_method("reported", {reported})}).methods[0].scan.has_value());
}

/// Reports nobody and says where the person of `made_up_dataset` got lost.
FindingRun losing_at(PersonStage stage) {
  return [stage](std::size_t, const TruthFrame& frame) {
    Findings findings;
    findings.people.emplace();
    findings.people->trail.emplace();
    findings.people->trail->boxes = 8;
    for (std::size_t i = 0; i < frame.truth.objects.size(); ++i)
      if (frame.truth.objects[i].type == "Pedestrian")
        findings.people->trail->paths.push_back({.object = i, .stage = stage, .rank = 0});
    return findings;
  };
}

TEST(Evaluate, TellsTheStagesThatLostPeople) {
  Dataset dataset = made_up_dataset(2);
  dataset.load = [load = dataset.load](std::size_t i) {
    TruthFrame frame = load(i);
    for (auto& object : frame.truth.objects) object.box = {20, 5, 20, 50};
    return frame;
  };
  const Method method{"loser", {losing_at(PersonStage::first_look), losing_at(PersonStage::second_look)}};
  const std::vector<std::size_t> frames = {0, 1};
  const Evaluation evaluation = evaluate(dataset, frames, {method});
  const PeopleResult& people = evaluation.methods[0].people.value();
  ASSERT_EQ(people.missed.size(), 1u);
  EXPECT_EQ(people.missed[0].stages[static_cast<std::size_t>(PersonStage::first_look)], 1);
  EXPECT_EQ(people.missed[0].stages[static_cast<std::size_t>(PersonStage::second_look)], 1);
  ASSERT_TRUE(people.losses.has_value());
  EXPECT_EQ(people.losses->people[static_cast<std::size_t>(PersonStage::first_look)], 1);
  EXPECT_NEAR(people.losses->boxes_per_pair, 8.0, kExact);
}

TEST(FliesMethod, RunsSeedsThatDifferAndRepeatThemselves) {
  DetectorOptions options;
  options.evolve.flies = 200;
  options.evolve.generations = 1;
  const TruthFrame frame = made_up_dataset(1).load(0);
  const Method method = flies_method("default", options, 2, default_people_classifier(), false);
  ASSERT_EQ(method.runs.size(), 2u);
  const Findings first = method.runs[0](0, frame);
  EXPECT_GE(first.evaluations.value(), 200.0);
  EXPECT_GT(first.time_ms.value(), 0.0);
  EXPECT_TRUE(first.obstacles.empty());  // a grey wall holds nothing to match
  EXPECT_TRUE(first.people->trail.has_value());
}

}  // namespace
}  // namespace flies
