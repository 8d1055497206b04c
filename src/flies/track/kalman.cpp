#include "flies/track/kalman.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace flies {
namespace {

Covariance4 product(const Covariance4& a, const Covariance4& b) {
  Covariance4 c{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t j = 0; j < 4; ++j) c[i][j] += a[i][k] * b[k][j];
  return c;
}

Covariance4 transposed(const Covariance4& a) {
  Covariance4 t{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) t[j][i] = a[i][j];
  return t;
}

double determinant(const Covariance2& a) { return a[0][0] * a[1][1] - a[0][1] * a[1][0]; }

Covariance2 inverse(const Covariance2& a) {
  const double d = determinant(a);
  return {{{a[1][1] / d, -a[0][1] / d}, {-a[1][0] / d, a[0][0] / d}}};
}

/// Which two of the state's numbers are measured: those from here on.
constexpr std::size_t kPosition = 0, kVelocity = 2;

Covariance2 innovation_covariance(const GroundState& s, const Covariance2& noise, std::size_t from) {
  Covariance2 sum{};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) sum[i][j] = s.covariance[from + i][from + j] + noise[i][j];
  return sum;
}

double squared(const Covariance2& inverse_covariance, double a, double b) {
  return inverse_covariance[0][0] * a * a + 2 * inverse_covariance[0][1] * a * b + inverse_covariance[1][1] * b * b;
}

/// The state given a measurement that differs by `difference` from what it says.
GroundState corrected(const GroundState& state, const std::array<double, 2>& difference, const Covariance2& noise,
                      std::size_t from) {
  const Covariance2 inverse_s = inverse(innovation_covariance(state, noise, from));
  std::array<std::array<double, 2>, 4> gain{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      for (std::size_t k = 0; k < 2; ++k) gain[i][j] += state.covariance[i][from + k] * inverse_s[k][j];
  const auto step = [&](std::size_t i) { return gain[i][0] * difference[0] + gain[i][1] * difference[1]; };
  GroundState next = state;
  next.x_m += step(0);
  next.y_m += step(1);
  next.vx_mps += step(2);
  next.vy_mps += step(3);
  // Joseph's form, which stays symmetric and positive however often it is repeated.
  Covariance4 keep{};
  for (std::size_t i = 0; i < 4; ++i) {
    keep[i][i] = 1.0;
    for (std::size_t j = 0; j < 2; ++j) keep[i][from + j] -= gain[i][j];
  }
  next.covariance = product(product(keep, state.covariance), transposed(keep));
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t l = 0; l < 2; ++l) next.covariance[i][j] += gain[i][k] * noise[k][l] * gain[j][l];
  return next;
}

}  // namespace

GroundState predict(const GroundState& state, const EgoMotion& ego, double acceleration_mps2) {
  const double t = ego.dt_s;
  const auto& r = ego.current_from_previous.rotation;
  const Point3 at = ego.current_from_previous({state.x_m + state.vx_mps * t, state.y_m + state.vy_mps * t, 0.0});
  GroundState next;
  next.x_m = at.x_m;
  next.y_m = at.y_m;
  next.vx_mps = r[0][0] * state.vx_mps + r[0][1] * state.vy_mps;
  next.vy_mps = r[1][0] * state.vx_mps + r[1][1] * state.vy_mps;

  Covariance4 step{};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      step[i][j] = r[i][j];
      step[i][j + 2] = r[i][j] * t;
      step[i + 2][j + 2] = r[i][j];
    }
  next.covariance = product(product(step, state.covariance), transposed(step));
  const double a2 = acceleration_mps2 * acceleration_mps2;
  for (std::size_t i = 0; i < 2; ++i) {
    next.covariance[i][i] += a2 * t * t * t * t / 4;
    next.covariance[i][i + 2] += a2 * t * t * t / 2;
    next.covariance[i + 2][i] += a2 * t * t * t / 2;
    next.covariance[i + 2][i + 2] += a2 * t * t;
  }
  // What is not known of the camera's motion moves the thing the other way: by velocity, and by yaw about the origin.
  const std::array<std::array<double, 3>, 2> by_ego = {{{-t, 0.0, at.y_m * t}, {0.0, -t, -at.x_m * t}}};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t l = 0; l < 3; ++l) next.covariance[i][j] += by_ego[i][k] * ego.covariance[k][l] * by_ego[j][l];
  return next;
}

Innovation innovation(const GroundState& state, const GroundPosition& measured) {
  const Covariance2 s = innovation_covariance(state, measured.covariance, kPosition);
  return {squared(inverse(s), measured.x_m - state.x_m, measured.y_m - state.y_m), std::log(determinant(s))};
}

GroundState update(const GroundState& state, const GroundPosition& measured) {
  return corrected(state, {measured.x_m - state.x_m, measured.y_m - state.y_m}, measured.covariance, kPosition);
}

GroundState update(const GroundState& state, const GroundVelocity& measured) {
  return corrected(state, {measured.vx_mps - state.vx_mps, measured.vy_mps - state.vy_mps}, measured.covariance,
                   kVelocity);
}

LikelyVelocity likely_velocity(const GroundState& state, double moving_prior, double moving_mps) {
  const auto& p = state.covariance;
  const Covariance2 standing = {{{p[2][2], p[2][3]}, {p[3][2], p[3][3]}}};
  Covariance2 moving = standing;
  moving[0][0] += moving_mps * moving_mps;
  moving[1][1] += moving_mps * moving_mps;
  const double log_ratio = 0.5 * (std::log(determinant(standing)) - std::log(determinant(moving)) +
                                  squared(inverse(standing), state.vx_mps, state.vy_mps) -
                                  squared(inverse(moving), state.vx_mps, state.vy_mps));
  const double odds = moving_prior / (1.0 - moving_prior) * std::exp(std::clamp(log_ratio, -50.0, 50.0));
  const double probability = odds / (1.0 + odds);
  return {probability * state.vx_mps, probability * state.vy_mps, probability};
}

}  // namespace flies
