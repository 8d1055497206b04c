#include "flies/eval/window_rates.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace flies {
namespace {

constexpr std::array<double, 2> kWanted = {0.1, 0.5};

/// 0, 1, ... count - 1.
std::vector<double> ramp(int count) {
  std::vector<double> values(static_cast<std::size_t>(count));
  std::iota(values.begin(), values.end(), 0.0);
  return values;
}

/// Ten negatives 0..9 in two pictures; positives of set a all above them, of set b half above 8.
WindowScores ten_and_eight() {
  return {{{"a", {20, 21, 22, 23}}, {"b", {8.5, 9.5, 2.5, 3.5}}}, {{0, 2, 4, 6, 8}, {1, 3, 5, 7, 9}}};
}

TEST(ThresholdAt, LetsNoMoreThanTheShareThrough) {
  EXPECT_EQ(threshold_at(ramp(1000), 1e-2), 989.0);
  EXPECT_EQ(threshold_at(ramp(1000), 1e-3), 998.0);
  EXPECT_EQ(threshold_at(ramp(1000), 1e-4), 999.0) << "less than one window: none may pass";
  EXPECT_EQ(threshold_at(ramp(1000), 0.0), 999.0);
  EXPECT_EQ(threshold_at(ramp(1000), 1.0), -std::numeric_limits<double>::infinity());
}

TEST(ThresholdAt, CountsTiesAsPassingTogether) {
  const std::vector<double> negatives = {5, 5, 5, 1, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(threshold_at(negatives, 0.2), 5.0) << "all three fives pass a lower threshold";
  EXPECT_EQ(threshold_at(negatives, 0.3), 1.0);
}

TEST(DetectionRates, AreOfAllSetsAndThenOfEach) {
  const auto rates = detection_rates(ten_and_eight(), kWanted, {.resamples = 0});
  ASSERT_EQ(rates.size(), 6u);
  // One of ten may pass: threshold 8; then five: threshold 4.
  const double expected[] = {6.0 / 8.0, 6.0 / 8.0, 1.0, 1.0, 2.0 / 4.0, 2.0 / 4.0};
  const char* const sets[] = {"", "", "a", "a", "b", "b"};
  for (std::size_t i = 0; i < rates.size(); ++i) {
    EXPECT_EQ(rates[i].set, sets[i]);
    EXPECT_DOUBLE_EQ(rates[i].rate, expected[i]) << i;
    EXPECT_EQ(rates[i].threshold, i % 2 == 0 ? 8.0 : 4.0);
    EXPECT_FALSE(rates[i].low);
  }
}

TEST(DetectionRates, SayWhichOfThemSoFewWindowsCannotTell) {
  const std::array<double, 3> wanted = {0.05, 0.1, 0.5};
  const auto rates = detection_rates(ten_and_eight(), wanted, {.resamples = 0});
  ASSERT_EQ(rates.size(), 9u);
  for (std::size_t i = 0; i < rates.size(); ++i) EXPECT_EQ(rates[i].is_measured, i % 3 != 0) << i;
  EXPECT_TRUE(can_tell(10000, 1e-4));
  EXPECT_FALSE(can_tell(9999, 1e-4));
  EXPECT_FALSE(can_tell(0, 1.0));
}

TEST(DetectionRates, GiveIntervalsAboutTheRateOfTheExpectedWidth) {
  // 100 of 200 people above all negatives: a standard error of 3.5 %, and 95 % within 6.9 % of the half.
  WindowScores scores{{{"a", std::vector<double>(200, 0.0)}}, {{1, 1}, {1, 1}}};
  std::fill_n(scores.positives[0].scores.begin(), 100, 2.0);
  constexpr double kSlack = 0.02;  // of the 1000 resamples' quantiles, and of half a person's steps
  const auto rates = detection_rates(scores, kWanted);
  ASSERT_TRUE(rates[0].low && rates[0].high);
  EXPECT_NEAR(*rates[0].low, 0.5 - 0.069, kSlack);
  EXPECT_NEAR(*rates[0].high, 0.5 + 0.069, kSlack);
}

TEST(DetectionRates, DrawWholePictures) {
  // Which picture is drawn decides the threshold: windows drawn one by one would hide that.
  const WindowScores scores{{{"a", std::vector<double>(1000, 5.0)}},
                            {std::vector<double>(1000, 0.0), std::vector<double>(1000, 9.0)}};
  const std::array<double, 1> half = {0.5};
  const auto rates = detection_rates(scores, half);
  EXPECT_EQ(rates[0].rate, 1.0);
  EXPECT_EQ(*rates[0].low, 0.0) << "the picture with high scores was drawn twice in a quarter of the resamples";
}

TEST(DetectionRates, RepeatThemselvesWithASeed) {
  const auto of_seed = [](std::uint64_t seed) {
    return detection_rates(ten_and_eight(), kWanted, {.resamples = 50, .seed = seed}).front();
  };
  EXPECT_EQ(of_seed(3).low, of_seed(3).low);
  EXPECT_EQ(of_seed(3).high, of_seed(3).high);
}

TEST(ErrorPoints, StepWhereAPersonMoreIsFound) {
  const auto points = error_points({{{"a", {3, 1.5}}}, {{2, 1}, {0, 0}}});
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].false_positives, 0.0);
  EXPECT_EQ(points[0].miss_rate, 0.5);
  EXPECT_EQ(points[1].false_positives, 0.25);
  EXPECT_EQ(points[1].miss_rate, 0.0);
}

TEST(ErrorPoints, LetEqualScoresThrough) {
  const auto points = error_points({{{"a", {1}}}, {{1, 0}}});
  EXPECT_EQ(points[0].false_positives, 0.5);
}

}  // namespace
}  // namespace flies
