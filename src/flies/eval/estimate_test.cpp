#include "flies/eval/estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace flies {
namespace {

using Group = MeasureKey::Group;

constexpr double kExact = 1e-9;  // sums of a few doubles
const MeasureKey kRecall{Group::all, "", "recall"};

/// A frame with one car, found or not.
FrameTruth frame_with_car() {
  FrameTruth truth;
  truth.objects.push_back({"Car", 0, {12, 0, 0, 4, 2}});
  return truth;
}

FrameScore score_of(const FrameTruth& truth, bool found) {
  Obstacle obstacle;
  obstacle.x_m = obstacle.range_m = 10.5;
  return found ? score_frame(truth, std::vector{obstacle}) : score_frame(truth, {});
}

struct Scores {
  std::vector<FrameTruth> truths;
  std::vector<std::vector<FrameScore>> runs;
};

/// `found[r]` of `frames` cars are found by run r.
Scores scores(std::size_t frames, const std::vector<std::size_t>& found) {
  Scores result;
  for (std::size_t f = 0; f < frames; ++f) result.truths.push_back(frame_with_car());
  for (const std::size_t count : found) {
    result.runs.emplace_back();
    for (std::size_t f = 0; f < frames; ++f) result.runs.back().push_back(score_of(result.truths[f], f < count));
  }
  return result;
}

TEST(EstimateMeasures, TakesMedianAndSpreadOverRuns) {
  const auto [truths, runs] = scores(10, {10, 4, 9});
  const auto estimates = estimate_measures(truths, runs);
  EXPECT_NEAR(estimates.at(kRecall).median, 0.9, kExact);
  EXPECT_NEAR(estimates.at(kRecall).spread, 0.6, kExact);
  EXPECT_NEAR(estimates.at({Group::by_class, "Car", "recall"}).median, 0.9, kExact);
  EXPECT_NEAR(estimates.at({Group::by_range, "10-20 m", "recall"}).median, 0.9, kExact);
  EXPECT_NEAR(estimates.at({Group::all, "", "absolute_range_error"}).median, 0.05, kExact);
  EXPECT_FALSE(estimates.contains({Group::by_range, "5-10 m", "recall"}));  // nothing stands there
}

TEST(EstimateMeasures, CoversTheBinomialIntervalOfIndependentFrames) {
  const auto [truths, runs] = scores(100, {80});
  const Estimate recall = estimate_measures(truths, runs).at(kRecall);
  // 0.8 +- 1.96 sqrt(0.8 * 0.2 / 100); 0.025 is four standard errors of a 2.5 % quantile of 1000 draws.
  constexpr double kHalf = 0.0784, kDraws = 0.025;
  ASSERT_TRUE(recall.low && recall.high);
  EXPECT_NEAR(*recall.low, 0.8 - kHalf, kDraws);
  EXPECT_NEAR(*recall.high, 0.8 + kHalf, kDraws);
}

TEST(EstimateMeasures, DrawsTheSameTwiceAndOtherwiseWithAnotherSeed) {
  const auto [truths, runs] = scores(40, {23});
  EstimateOptions options;
  options.resamples = 20;
  const auto low = [&] { return *estimate_measures(truths, runs, options).at(kRecall).low; };
  const double first = low();
  EXPECT_EQ(first, low());
  bool differs = false;
  for (options.seed = 2; options.seed < 6; ++options.seed) differs |= low() != first;
  EXPECT_TRUE(differs);
}

TEST(EstimateMeasures, GivesNoIntervalForOneFrameOrWithoutDraws) {
  const auto one = scores(1, {1});
  EXPECT_FALSE(estimate_measures(one.truths, one.runs).at(kRecall).low.has_value());
  auto one_that_counts = scores(5, {5});
  for (std::size_t f = 1; f < 5; ++f) one_that_counts.runs[0][f].objects[0].counted = false;
  const auto estimates = estimate_measures(one_that_counts.truths, one_that_counts.runs);
  EXPECT_FALSE(estimates.at(kRecall).low.has_value());
  EXPECT_TRUE(estimates.at({Group::all, "", "obstacles_per_frame"}).low.has_value());
  const auto many = scores(5, {1});
  EstimateOptions options;
  options.resamples = 0;
  EXPECT_FALSE(estimate_measures(many.truths, many.runs, options).at(kRecall).high.has_value());
}

TEST(EstimateMeasures, LeavesOutWhatCannotBeMeasured) {
  const auto [truths, runs] = scores(3, {0});
  const auto estimates = estimate_measures(truths, runs);
  EXPECT_EQ(estimates.at(kRecall).median, 0.0);
  EXPECT_FALSE(estimates.contains({Group::all, "", "range_error"}));
  EXPECT_FALSE(estimates.contains({Group::all, "", "precision"}));
}

}  // namespace
}  // namespace flies
