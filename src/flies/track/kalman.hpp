#pragma once

#include <array>

#include "flies/ego/ego_motion.hpp"

namespace flies {

/// Symmetric; rows and columns x, y or x, y, vx, vy in metres and metres a second.
using Covariance2 = std::array<std::array<double, 2>, 2>;
using Covariance4 = std::array<std::array<double, 4>, 4>;

/// Where something stands on the ground and how it moves, with the uncertainty of both. Axes of the vehicle frame;
/// the velocity is over ground, so that of standing things is zero however the camera moves.
struct GroundState {
  double x_m = 0.0, y_m = 0.0;
  double vx_mps = 0.0, vy_mps = 0.0;
  Covariance4 covariance{};
};

/// A measured position.
struct GroundPosition {
  double x_m = 0.0, y_m = 0.0;
  Covariance2 covariance{};
};

/// Moves the state on by the time of `ego` at constant velocity and into the vehicle frame of now.
/// @param acceleration_mps2 standard deviation of what changes the velocity, in each direction
GroundState predict(const GroundState& state, const EgoMotion& ego, double acceleration_mps2);

/// Squared Mahalanobis distance of the measurement from the state, and the logarithm of the determinant of its
/// covariance: minus twice the log-likelihood but for a constant is their sum.
struct Innovation {
  double squared_distance = 0.0;
  double log_determinant = 0.0;
};
Innovation innovation(const GroundState& state, const GroundPosition& measured);

/// The state given the measurement as well.
GroundState update(const GroundState& state, const GroundPosition& measured);

/// A measured velocity over ground.
struct GroundVelocity {
  double vx_mps = 0.0, vy_mps = 0.0;
  Covariance2 covariance{};
};
GroundState update(const GroundState& state, const GroundVelocity& measured);

/// A velocity that may be none at all: most things stand, and the noise of a position alone gives each a velocity.
/// Spike and slab: the prior is zero with probability 1 - `moving_prior`, else normal with `moving_mps`.
struct LikelyVelocity {
  double vx_mps = 0.0, vy_mps = 0.0;  ///< posterior mean
  double moving_probability = 0.0;
};
LikelyVelocity likely_velocity(const GroundState& state, double moving_prior, double moving_mps);

}  // namespace flies
