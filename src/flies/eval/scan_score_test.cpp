#include "flies/eval/scan_score.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace flies {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kExact = 1e-9;

/// A sector a range: judged when it is finite, open when it is infinite, else ignored.
ScanTruth truth_of(std::vector<double> ranges_m) {
  ScanTruth truth;
  truth.bearings = {-0.1, 0.01, ranges_m.size()};
  for (const double range_m : ranges_m)
    truth.kinds.push_back(std::isnan(range_m)   ? TrueSector::ignored
                          : std::isinf(range_m) ? TrueSector::open
                                                : TrueSector::counted);
  truth.ranges_m = std::move(ranges_m);
  return truth;
}

/// Obstacles at finite ranges, infinity for free, NaN for unknown.
Scan scan_of(const std::vector<double>& ranges_m) {
  Scan scan;
  scan.angle_min_rad = -0.1;
  scan.angle_increment_rad = 0.01;
  for (const double range_m : ranges_m) {
    scan.states.push_back(std::isnan(range_m)   ? SectorState::unknown
                          : std::isinf(range_m) ? SectorState::free
                                                : SectorState::obstacle);
    scan.ranges_m.push_back(std::isfinite(range_m) ? range_m : kNaN);
    scan.free_m.push_back(std::isinf(range_m) ? 20.0 : 0.0);
    scan.confidence.push_back(std::isnan(range_m) ? 0.0 : 0.5);
  }
  return scan;
}

std::map<MeasureKey, double> values_of(const ScanScore& score) {
  constexpr std::size_t kFrame = 0;
  return scan_values(std::span(&score, 1), std::span(&kFrame, 1));
}

TEST(ScoreScan, TellsRightBlindGhostAndUnknownApart) {
  // At 10 m ranges agree within 1.25 m.
  const ScanTruth truth = truth_of({10, 10, 10, 10, 10, 10, 20});
  const ScanScore score = score_scan(truth, scan_of({11.2, 8.8, 11.3, kInfinity, 8.7, kNaN, kInfinity}));
  EXPECT_EQ(score.sectors, 7);
  EXPECT_EQ(score.right, 2);
  EXPECT_EQ(score.blind, 3);
  EXPECT_EQ(score.ghost, 1);
  EXPECT_EQ(score.unknown, 1);
  EXPECT_EQ(score.near_sectors, 6);
  EXPECT_EQ(score.near_blind, 2);
  const auto values = values_of(score);
  const auto value = [&](const char* name) { return values.at({MeasureKey::Group::all, "", name}); };
  EXPECT_NEAR(value("right") + value("blind") + value("ghost") + value("unknown"), 1.0, kExact);
  EXPECT_NEAR(value("near_blind"), 2.0 / 6.0, kExact);
  EXPECT_NEAR(value("absolute_range_error"), 0.12, kExact);
  EXPECT_NEAR(value("range_error"), 0.0, kExact);
}

TEST(ScoreScan, CountsReportsInOpenSectors) {
  const ScanTruth truth = truth_of({kInfinity, kInfinity, kInfinity, kInfinity, kNaN});
  const ScanScore score = score_scan(truth, scan_of({12, 31, kInfinity, kNaN, 5}));
  EXPECT_EQ(score.sectors, 0);
  EXPECT_EQ(score.open_sectors, 4);
  EXPECT_EQ(score.open_ghost, 1);
  EXPECT_FALSE(values_of(score).contains({MeasureKey::Group::all, "", "right"}));
}

TEST(ScoreScan, SaysUnknownOutsideTheScan) {
  const ScanTruth truth = truth_of({10, 10, 10});
  EXPECT_EQ(score_scan(truth, {}).unknown, 3);
  const ScanScore score = score_scan(truth, scan_of({10, 10}));
  EXPECT_EQ(score.right, 2);
  EXPECT_EQ(score.unknown, 1);
}

TEST(ScoreScan, AsksTheSectorInWhichTheMiddleLies) {
  Scan coarse = scan_of({7, 14});
  coarse.angle_min_rad = -0.1;
  coarse.angle_increment_rad = 0.03;  // from -0.115 to -0.085 and on to -0.055
  const ScanScore score = score_scan(truth_of({7, 7, 14, 14, 14}), coarse);
  EXPECT_EQ(score.right, 5);
}

TEST(ScoreScan, AddsUpOverPairs) {
  const std::array scores = {score_scan(truth_of({10, 10}), scan_of({10, 10})),
                             score_scan(truth_of({10, 10}), scan_of({kInfinity, kInfinity}))};
  const std::array<std::size_t, 3> frames = {0, 0, 1};
  const auto values = scan_values(scores, frames);
  EXPECT_NEAR(values.at({MeasureKey::Group::all, "", "right"}), 4.0 / 6.0, kExact);
  EXPECT_NEAR(values.at({MeasureKey::Group::all, "", "blind"}), 2.0 / 6.0, kExact);
}

TEST(WithMinConfidence, TakesUncertainObstaclesBack) {
  Scan scan = scan_of({10, 12, kInfinity, kNaN});
  scan.confidence = {0.9, 0.3, 0.1, 0.0};
  const Scan sure = with_min_confidence(scan, 0.5);
  EXPECT_EQ(sure.states,
            (std::vector{SectorState::obstacle, SectorState::free, SectorState::free, SectorState::unknown}));
  EXPECT_EQ(sure.ranges_m[0], 10.0);
  EXPECT_TRUE(std::isnan(sure.ranges_m[1]));
  EXPECT_EQ(with_min_confidence(scan, 0.3).states, scan.states);
}

}  // namespace
}  // namespace flies
