#include "flies/train/calibrate.hpp"

#include <gmock/gmock.h>

#include <vector>

#include "flies/core/random.hpp"

namespace flies {
namespace {

/// Scores of two classes drawn from the sigmoid itself.
struct Drawn {
  std::vector<double> people, background;
};

Drawn draw(const ScoreCalibration& truth, int count) {
  Drawn drawn;
  FlyRandom random(1, 0, 0, 0);
  for (int i = 0; i < count; ++i) {
    const double score = random.uniform(-3.0, 3.0);
    (random.uniform() < probability(truth, score) ? drawn.people : drawn.background).push_back(score);
  }
  return drawn;
}

TEST(FitCalibration, FindsTheSigmoidThatTheScoresWereDrawnFrom) {
  constexpr double kTolerance = 0.1;  // about three standard errors for 20,000 draws
  const ScoreCalibration truth{2.0, -1.0};
  const Drawn drawn = draw(truth, 20000);
  const ScoreCalibration fit = fit_calibration(drawn.people, drawn.background);
  EXPECT_NEAR(fit.slope, truth.slope, kTolerance);
  EXPECT_NEAR(fit.offset, truth.offset, kTolerance);
}

TEST(FitCalibration, IsNeverCertainOfSeparableScores) {
  const std::vector<double> people = {1.0, 2.0, 3.0}, background = {-3.0, -2.0, -1.0};
  const ScoreCalibration fit = fit_calibration(people, background);
  EXPECT_GT(probability(fit, 2.0), 0.7);
  EXPECT_LT(probability(fit, 2.0), 0.95);
  EXPECT_LT(probability(fit, -2.0), 0.3);
}

TEST(FitCalibration, StaysRisingWhenPeopleScoreLowerOrAreMissing) {
  const std::vector<double> high = {1.0, 2.0}, low = {-1.0, -2.0};
  EXPECT_GT(fit_calibration(low, high).slope, 0.0);
  EXPECT_GT(fit_calibration({}, high).slope, 0.0);
  EXPECT_GT(fit_calibration(high, {}).slope, 0.0);
}

}  // namespace
}  // namespace flies
