#include "flies/eval/reliability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace flies {
namespace {

double log_odds(double probability) { return std::log(probability / (1.0 - probability)); }

/// So many windows with and without a person at one probability.
WindowScores at(double probability, std::size_t people, std::size_t others) {
  return {{{"a", std::vector<double>(people, log_odds(probability))}},
          {std::vector<double>(others, log_odds(probability))}};
}

TEST(Reliability, HasNoErrorWhereProbabilitiesAreShares) {
  // One window in ten shows a person, however many there are of each.
  const Reliability result = reliability(at(kReliabilityPeople, 5, 2000));
  EXPECT_NEAR(result.calibration_error, 0.0, 1e-12);
  ASSERT_EQ(result.bins.size(), 10U);
  EXPECT_EQ(result.bins[1].people + result.bins[0].people, 5U);
}

TEST(Reliability, HasTheDistanceOfProbabilityAndShareAsItsError) {
  const Reliability result = reliability(at(0.75, 10, 10));
  EXPECT_NEAR(result.bins[7].mean_probability, 0.75, 1e-12);
  EXPECT_NEAR(result.bins[7].people_share, 0.1, 1e-12);
  EXPECT_NEAR(result.calibration_error, 0.65, 1e-12);
}

TEST(Reliability, WeighsBinsByTheirWindows) {
  // People at 0.95, half of the others there too: 0.1 of 0.55 are people there, none of 0.45 at 0.05.
  WindowScores scores = at(0.95, 4, 2);
  scores.negatives.push_back(std::vector<double>(2, log_odds(0.05)));
  EXPECT_NEAR(reliability(scores).calibration_error, 0.55 * (0.95 - 0.1 / 0.55) + 0.45 * 0.05, 1e-12);
}

TEST(Reliability, TakesCertainty) {
  constexpr double kSure = std::numeric_limits<double>::infinity();
  const WindowScores scores{{{"a", {kSure}}}, {{-kSure}}};
  const Reliability result = reliability(scores);
  EXPECT_EQ(result.bins.back().people, 1U);
  EXPECT_EQ(result.bins.front().others, 1U);
  EXPECT_EQ(result.calibration_error, 0.0);
}

}  // namespace
}  // namespace flies
