#include "flies/track/kalman.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "flies/core/random.hpp"
#include "flies/track/toy_sightings.hpp"

namespace flies {
namespace {

using testing::kDt_s;
using testing::standing;

TEST(Predict, KeepsStandingThingsStandingWhileTheCameraTurns) {
  GroundState state{.x_m = 10, .y_m = 2};
  for (int i = 0; i < 10; ++i) state = predict(state, given_ego_motion(kDt_s, 5.0, 0.0, 0.3), 1.0);
  EXPECT_EQ(state.vx_mps, 0.0);
  // An arc of 5 m with 0.3 rad: the way of the origin, then the turn.
  const double radius = 5.0 / 0.3, dx = 10 - radius * std::sin(0.3), dy = 2 - radius * (1 - std::cos(0.3));
  EXPECT_NEAR(state.x_m, std::cos(0.3) * dx + std::sin(0.3) * dy, 0.01);
  EXPECT_NEAR(state.y_m, -std::sin(0.3) * dx + std::cos(0.3) * dy, 0.01);
}

TEST(Predict, TakesOverWhatIsNotKnownOfTheCamera) {
  const GroundState state{.x_m = 10, .y_m = 0};
  const auto sure = predict(state, given_ego_motion(kDt_s, 5, 0, 0), 0.01);
  const auto unsure = predict(state, given_ego_motion(kDt_s, 5, 0, 0, {2.0, 0.0, 0.5}), 0.01);
  EXPECT_NEAR(unsure.covariance[0][0] - sure.covariance[0][0], 0.2 * 0.2, 1e-9);      // 2 m/s for 0.1 s
  EXPECT_NEAR(unsure.covariance[1][1] - sure.covariance[1][1], 0.475 * 0.475, 1e-9);  // 0.05 rad at 9.5 m
}

// Simulated as the filter assumes: the normalised squared error of four numbers is 4 on average.
TEST(Kalman, ItsCovarianceHasTheSizeOfItsErrors) {
  constexpr int kTrials = 300, kSteps = 15;
  const Covariance2 noise = {{{0.09, 0.0}, {0.0, 0.01}}};
  double distance = 0.0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    FlyRandom random(4, 0, trial, 0);
    GroundState truth{.x_m = 15, .y_m = 0, .vx_mps = 5 * random.normal(), .vy_mps = 5 * random.normal()};
    GroundState state;
    for (int step = 0; step < kSteps; ++step) {
      const GroundPosition measured{truth.x_m + 0.3 * random.normal(), truth.y_m + 0.1 * random.normal(), noise};
      if (step == 0) {
        state = {.x_m = measured.x_m, .y_m = measured.y_m};
        state.covariance[0][0] = 0.09;
        state.covariance[1][1] = 0.01;
        state.covariance[2][2] = state.covariance[3][3] = 25.0;
      } else {
        state = update(state, measured);
      }
      if (step + 1 == kSteps) break;
      const double ax = random.normal(), ay = random.normal();
      truth.x_m += truth.vx_mps * kDt_s + 0.5 * ax * kDt_s * kDt_s;
      truth.y_m += truth.vy_mps * kDt_s + 0.5 * ay * kDt_s * kDt_s;
      truth.vx_mps += ax * kDt_s;
      truth.vy_mps += ay * kDt_s;
      state = predict(state, standing(), 1.0);
    }
    // x and y are independent here: two blocks of two.
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto& p = state.covariance;
      const double e = axis == 0 ? state.x_m - truth.x_m : state.y_m - truth.y_m;
      const double ev = axis == 0 ? state.vx_mps - truth.vx_mps : state.vy_mps - truth.vy_mps;
      const double a = p[axis][axis], b = p[axis][axis + 2], c = p[axis + 2][axis + 2];
      distance += (c * e * e - 2 * b * e * ev + a * ev * ev) / (a * c - b * b);
    }
  }
  EXPECT_NEAR(distance / kTrials, 4.0, 0.6);  // standard error sqrt(8/300) = 0.16
}

TEST(LikelyVelocity, TellsNoiseFromMotion) {
  GroundState state{.x_m = 10, .y_m = 0, .vx_mps = 1.0, .vy_mps = 0.0};
  state.covariance[2][2] = state.covariance[3][3] = 1.0;
  const auto noise = likely_velocity(state, 0.15, 5.0);
  EXPECT_LT(noise.moving_probability, 0.1);
  EXPECT_LT(noise.vx_mps, 0.1);
  state.covariance[2][2] = state.covariance[3][3] = 0.02;
  const auto motion = likely_velocity(state, 0.15, 5.0);
  EXPECT_GT(motion.moving_probability, 0.99);
  EXPECT_NEAR(motion.vx_mps, 1.0, 0.01);
}

}  // namespace
}  // namespace flies
