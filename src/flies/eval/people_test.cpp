#include "flies/eval/people.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace flies {
namespace {

using Group = MeasureKey::Group;
using Kind = PersonVerdict::Kind;

constexpr double kExact = 1e-9;  // sums of a few doubles

/// 41 px wide and 100 px high, as people count: nothing to standardise.
ImageBox box_at(double u_px, double height_px = 100.0) { return {u_px, 50.0, 0.41 * height_px, height_px}; }

/// Straight ahead or a little beside, its near face at `range_m`.
LabelledObject person_at(double u_px, double range_m, const std::string& type = "Pedestrian") {
  LabelledObject object;
  object.type = type;
  object.footprint = {range_m + 0.25, 0.0, 0.0, 0.5, 0.5};
  object.box = box_at(u_px);
  return object;
}

Pedestrian report_at(double u_px, double probability, double range_m = 10.0) {
  Pedestrian person;
  person.x_m = range_m;
  person.range_m = range_m;
  person.probability = probability;
  person.box = box_at(u_px);
  return person;
}

FrameTruth truth_of(std::vector<LabelledObject> objects) {
  FrameTruth truth;
  truth.objects = std::move(objects);
  return truth;
}

std::vector<Kind> kinds(const PeopleFrame& frame) {
  std::vector<Kind> found;
  for (const auto& verdict : frame.verdicts) found.push_back(verdict.kind);
  return found;
}

TEST(IntersectionOverUnion, IsThatOfAreas) {
  EXPECT_NEAR(intersection_over_union({0, 0, 10, 10}, {5, 0, 10, 10}), 1.0 / 3.0, kExact);
  EXPECT_EQ(intersection_over_union({0, 0, 10, 10}, {0, 0, 10, 10}), 1.0);
  EXPECT_EQ(intersection_over_union({0, 0, 10, 10}, {10, 0, 10, 10}), 0.0);
  EXPECT_EQ(intersection_over_union({}, {}), 0.0);
}

TEST(PersonRole, CountsVisiblePedestriansOfSizeAndRange) {
  const PeopleOptions options;
  EXPECT_EQ(person_role(person_at(0, 10), options), PersonRole::counted);
  EXPECT_EQ(person_role(person_at(0, 25.1), options), PersonRole::ignored);
  for (const char* type : {"Cyclist", "Person_sitting", "Person (sitting)"})
    EXPECT_EQ(person_role(person_at(0, 10, type), options), PersonRole::ignored) << type;
  for (const char* type : {"Car", "Pole", "Tram"})
    EXPECT_EQ(person_role(person_at(0, 10, type), options), PersonRole::other) << type;
  LabelledObject hidden = person_at(0, 10), small = person_at(0, 10);
  hidden.visible = false;
  small.box = box_at(0, 39.0);
  EXPECT_EQ(person_role(hidden, options), PersonRole::ignored);
  EXPECT_EQ(person_role(small, options), PersonRole::ignored);
}

TEST(ScorePeople, CallsTheSecondReportOfAPersonAFalseAlarm) {
  const auto frame =
      score_people(truth_of({person_at(100, 10)}), std::vector{report_at(104, 1.0), report_at(100, 2.0)});
  EXPECT_EQ(kinds(frame), (std::vector{Kind::hit, Kind::false_alarm}));
  EXPECT_EQ(frame.verdicts[0].person.probability, 2.0) << "the surest first";
}

TEST(ScorePeople, GivesTheSurerReportThePersonItOverlapsMost) {
  const auto frame = score_people(truth_of({person_at(100, 10), person_at(110, 12)}),
                                  std::vector{report_at(109, 2.0), report_at(102, 1.0)});
  ASSERT_EQ(kinds(frame), (std::vector{Kind::hit, Kind::hit}));
  EXPECT_EQ(frame.verdicts[0].object, 1);
  EXPECT_EQ(frame.verdicts[1].object, 0);
}

TEST(ScorePeople, AsksForHalfOverlap) {
  // Shifted by a third of the width, the intersection over union is (2/3) / (4/3).
  const double third_px = 41.0 / 3.0;
  const FrameTruth truth = truth_of({person_at(100, 10)});
  EXPECT_EQ(kinds(score_people(truth, std::vector{report_at(100 + third_px - 0.1, 1)})), (std::vector{Kind::hit}));
  EXPECT_EQ(kinds(score_people(truth, std::vector{report_at(100 + third_px + 0.1, 1)})),
            (std::vector{Kind::false_alarm}));
}

TEST(ScorePeople, DoesNotMindArmsAndStrides) {
  LabelledObject striding = person_at(100, 10);
  striding.box = {80.0, 50.0, 81.0, 100.0};
  EXPECT_EQ(kinds(score_people(truth_of({striding}), std::vector{report_at(100, 1)})), (std::vector{Kind::hit}));
}

TEST(ScorePeople, IgnoresReportsInIgnoredPeopleAndRegions) {
  FrameTruth truth = truth_of({person_at(100, 10, "Cyclist"), person_at(300, 10, "Car")});
  truth.ignored_regions.push_back({490, 0, 200, 300});
  const auto frame =
      score_people(truth, std::vector{report_at(100, 4), report_at(101, 3), report_at(300, 2), report_at(500, 1)});
  EXPECT_EQ(kinds(frame), (std::vector{Kind::ignored, Kind::ignored, Kind::false_alarm, Kind::ignored}));
}

TEST(ScorePeople, MeasuresRangeAndPosition) {
  Pedestrian report = report_at(100, 1.0, 10.4);
  report.y_m = 1.25;
  const auto frame = score_people(truth_of({person_at(100, 10)}), std::vector{report});
  ASSERT_EQ(frame.verdicts[0].kind, Kind::hit);
  // The line of sight passes beside the footprint, whose nearest point is then its near face.
  EXPECT_NEAR(frame.verdicts[0].near_range_m, 10.0, kExact);
  EXPECT_NEAR(frame.verdicts[0].range_error_m, 0.4, kExact);
  EXPECT_NEAR(frame.verdicts[0].position_error_m, std::hypot(0.4, 1.25), kExact);
}

TEST(LogAverageMissRate, IsTheRateOfAFlatCurve) {
  const ErrorPoint flat[] = {{0.0, 0.3}};
  EXPECT_NEAR(log_average_miss_rate(flat, 1000), 0.3, kExact);
}

TEST(LogAverageMissRate, MissesAllLeftOfTheCurve) {
  EXPECT_NEAR(log_average_miss_rate({}, 10), 1.0, kExact);
  // At 0.1, the fifth of nine references, the rate falls to 0.01: the mean of four times 1 and five times 0.01.
  const ErrorPoint late[] = {{0.1, 0.01}};
  EXPECT_NEAR(log_average_miss_rate(late, 1000), std::pow(0.01, 5.0 / 9.0), kExact);
  const ErrorPoint too_late[] = {{1.01, 0.0}};
  EXPECT_NEAR(log_average_miss_rate(too_late, 10), 1.0, kExact);
}

TEST(LogAverageMissRate, CountsNothingMissedAsHalfAPerson) {
  const ErrorPoint perfect[] = {{0.0, 0.0}};
  EXPECT_NEAR(log_average_miss_rate(perfect, 20), 0.025, kExact);
}

/// Two pairs: a person found at 10 m and one missed at 20 m, with a false alarm of each score 3 and 0.5.
PeopleRun two_pairs() {
  return {
      score_people(truth_of({person_at(100, 10)}), std::vector{report_at(100, 2.0, 10.5), report_at(400, 3.0, 5.0)}),
      score_people(truth_of({person_at(100, 20)}), std::vector{report_at(101, 1.0, 20.4), report_at(400, 0.5, 15.0)})};
}

TEST(PeopleCurve, StepsWhereAPersonMoreIsFound) {
  const PeopleRun run = two_pairs();
  const auto points = people_curve({&run, 1});
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].false_positives, 0.5);
  EXPECT_EQ(points[0].miss_rate, 0.5);
  EXPECT_EQ(points[1].false_positives, 0.5);
  EXPECT_EQ(points[1].miss_rate, 0.0);
}

TEST(PeopleCurve, PoolsRuns) {
  const std::vector<PeopleRun> runs = {two_pairs(), {two_pairs()[0], score_people(truth_of({person_at(100, 20)}), {})}};
  EXPECT_NEAR(people_curve(runs).back().miss_rate, 0.25, kExact);
}

TEST(PeopleOperatingPoint, CountsWhatExceedsTheThreshold) {
  const PeopleRun run = two_pairs();
  const auto at_one = people_operating_point({&run, 1}, 1.0);
  EXPECT_NEAR(at_one.false_positives, 0.5, kExact);
  EXPECT_NEAR(at_one.miss_rate, 0.5, kExact) << "a report of that very probability is not made";
  EXPECT_NEAR(people_operating_point({&run, 1}, 0.0).false_positives, 1.0, kExact);
}

TEST(PeopleValues, AreOfAllAndOfEachBand) {
  const std::vector<std::size_t> both = {0, 1};
  const auto values = people_values(two_pairs(), both, 0.7);
  EXPECT_EQ(values.at({Group::all, "", "miss_rate"}), 0.0);
  EXPECT_EQ(values.at({Group::all, "", "false_alarms_per_frame"}), 0.5);
  EXPECT_NEAR(values.at({Group::all, "", "range_error"}), (0.05 + 0.02) / 2, kExact);
  EXPECT_NEAR(values.at({Group::all, "", "absolute_range_error_95"}), 0.05, kExact);
  EXPECT_EQ(values.at({Group::by_range, "0-10 m", "false_alarms_per_frame"}), 0.5);
  EXPECT_FALSE(values.contains({Group::by_range, "0-10 m", "miss_rate"})) << "nobody stands there";
  EXPECT_EQ(values.at({Group::by_range, "10-20 m", "miss_rate"}), 0.0);
  EXPECT_EQ(values.at({Group::by_range, "20-25 m", "miss_rate"}), 0.0);
  EXPECT_NEAR(values.at({Group::by_range, "20-25 m", "range_error"}), 0.02, kExact);
}

TEST(PeopleValues, CountAFrameNamedTwiceTwice) {
  const std::vector<std::size_t> drawn = {0, 0, 1};
  EXPECT_NEAR(people_values(two_pairs(), drawn, 1.5).at({Group::all, "", "miss_rate"}), 1.0 / 3.0, kExact);
}

TEST(PeopleByRange, CountsThoseToBeFound) {
  const auto parts = people_by_range(two_pairs());
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(parts[1], (std::pair<std::string, int>("10-20 m", 1)));
  EXPECT_EQ(parts[2], (std::pair<std::string, int>("20-25 m", 1)));
  EXPECT_EQ(people_by_range(two_pairs(), {.max_range_m = 60}).back().first, "40-60 m");
}

}  // namespace
}  // namespace flies
