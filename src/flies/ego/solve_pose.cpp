#include "flies/ego/solve_pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "flies/core/random.hpp"

namespace flies::ego {
namespace {

constexpr double kMinDepth_m = 0.2;
constexpr std::uint64_t kSeed = 0x65676f;  // of the triples: results do not depend on the detector's seed
constexpr int kTripleSteps = 5, kRefineSteps = 8;

/// Rodrigues' formula.
cv::Matx33d turn(const cv::Vec3d& w) {
  const double angle = cv::norm(w);
  const double a = angle < 1e-9 ? 1.0 : std::sin(angle) / angle;
  const double b = angle < 1e-9 ? 0.5 : (1.0 - std::cos(angle)) / (angle * angle);
  const cv::Matx33d k(0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0);
  return cv::Matx33d::eye() + a * k + b * (k * k);
}

struct Residual {
  bool is_valid = false;
  cv::Vec2d px;
  cv::Vec3d turned, at;
};

Residual residual_of(const FollowedCorner& corner, const Pinhole& camera, const CameraMotion& motion) {
  Residual r;
  r.turned = motion.rotation * corner.before_m;
  r.at = r.turned + motion.shift_m;
  if (!(r.at[2] > kMinDepth_m)) return r;
  r.is_valid = true;
  r.px = {corner.now_px[0] - (camera.cx_px + camera.f_px * r.at[0] / r.at[2]),
          corner.now_px[1] - (camera.cy_px + camera.fy_px * r.at[1] / r.at[2])};
  return r;
}

/// Normal equations of weighted least squares. The first six parameters are a small turn after the rotation, then the
/// shift; others may move the points.
template <int N>
struct NormalEquations {
  cv::Matx<double, N, N> a;
  cv::Vec<double, N> b;

  /// @param by_others derivatives of `r.at` by the parameters behind the first six
  void add(const Residual& r, const Pinhole& camera, double weight,
           const std::array<cv::Vec3d, N - 6>& by_others = {}) {
    const double z = r.at[2], z2 = z * z;
    const std::array<cv::Vec3d, 2> by_point = {cv::Vec3d{camera.f_px / z, 0.0, -camera.f_px * r.at[0] / z2},
                                               cv::Vec3d{0.0, camera.fy_px / z, -camera.fy_px * r.at[1] / z2}};
    for (int axis = 0; axis < 2; ++axis) {
      const cv::Vec3d& g = by_point[static_cast<std::size_t>(axis)];
      const cv::Vec3d by_turn = r.turned.cross(g);  // d(w x p)/dw, contracted with g
      std::array<double, N> j = {by_turn[0], by_turn[1], by_turn[2], g[0], g[1], g[2]};
      for (std::size_t i = 0; i < by_others.size(); ++i) j[6 + i] = g.dot(by_others[i]);
      for (int i = 0; i < N; ++i) {
        b[i] += weight * j[static_cast<std::size_t>(i)] * r.px[axis];
        for (int k = 0; k < N; ++k) a(i, k) += weight * j[static_cast<std::size_t>(i)] * j[static_cast<std::size_t>(k)];
      }
    }
  }

  /// One step of Gauss and Newton. @returns by how much the parameters change; nothing when that cannot be solved
  std::optional<cv::Vec<double, N>> step(CameraMotion& motion) const {
    bool solved = false;
    const auto inverse = a.inv(cv::DECOMP_CHOLESKY, &solved);
    if (!solved) return std::nullopt;
    const cv::Vec<double, N> d = inverse * b;
    motion.rotation = turn({d[0], d[1], d[2]}) * motion.rotation;
    motion.shift_m += cv::Vec3d(d[3], d[4], d[5]);
    return std::isfinite(cv::norm(d)) ? std::optional(d) : std::nullopt;
  }
};

/// Of a corner in least squares: Tukey's biweight, by which those beyond the limit do not pull at all.
double weight_of(const Residual& r, double limit_px) {
  const double share = r.px.dot(r.px) / (limit_px * limit_px);
  return r.is_valid && share < 1.0 ? (1.0 - share) * (1.0 - share) : 0.0;
}

std::optional<CameraMotion> motion_of_triple(std::span<const FollowedCorner> corners,
                                             const std::array<std::size_t, 3>& triple, const Pinhole& camera,
                                             CameraMotion motion) {
  for (int iteration = 0; iteration < kTripleSteps; ++iteration) {
    NormalEquations<6> equations;
    for (const std::size_t i : triple) {
      const Residual r = residual_of(corners[i], camera, motion);
      if (!r.is_valid) return std::nullopt;
      equations.add(r, camera, 1.0);
    }
    if (!equations.step(motion)) return std::nullopt;
  }
  return motion;
}

int count_agreeing(std::span<const FollowedCorner> corners, const Pinhole& camera, const CameraMotion& motion,
                   double max_px) {
  return static_cast<int>(std::count_if(corners.begin(), corners.end(), [&](const FollowedCorner& corner) {
    const Residual r = residual_of(corner, camera, motion);
    return r.is_valid && r.px.dot(r.px) < max_px * max_px;
  }));
}

}  // namespace

CameraMotion scaled(const CameraMotion& motion, double times) {
  const auto& r = motion.rotation;
  const cv::Vec3d axis(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));  // times twice the sine
  const double length = cv::norm(axis), angle = std::atan2(length, cv::trace(r) - 1.0);
  return {length > 0.0 ? turn(axis * (times * angle / length)) : r, motion.shift_m * times};
}

std::optional<PoseResult> solve_pose(std::span<const FollowedCorner> corners, const Pinhole& camera,
                                     const CameraMotion& start, const EgoOptions& options, std::uint32_t frame) {
  if (corners.size() < 3) return std::nullopt;
  PoseResult best{start, {}, count_agreeing(corners, camera, start, options.max_residual_px)};
  for (int h = 0; h < options.hypotheses; ++h) {
    FlyRandom random(kSeed, 0, frame, static_cast<std::uint32_t>(h));
    std::array<std::size_t, 3> triple{};
    for (auto& i : triple) i = random.below(static_cast<std::uint32_t>(corners.size()));
    if (triple[0] == triple[1] || triple[1] == triple[2] || triple[0] == triple[2]) continue;
    const auto motion = motion_of_triple(corners, triple, camera, start);
    if (!motion) continue;
    const int agreeing = count_agreeing(corners, camera, *motion, options.max_residual_px);
    if (agreeing > best.agreeing) best = {*motion, {}, agreeing};
  }

  double scatter_px2 = 0.0;
  NormalEquations<6> equations;
  for (int iteration = 0; iteration < kRefineSteps; ++iteration) {
    equations = {};
    double weights = 0.0, squares = 0.0;
    best.agreeing = 0;
    for (const auto& corner : corners) {
      const Residual r = residual_of(corner, camera, best.motion);
      const double weight = weight_of(r, options.max_residual_px);
      if (weight == 0.0) continue;
      equations.add(r, camera, weight);
      weights += weight;
      squares += weight * r.px.dot(r.px);
      ++best.agreeing;
    }
    scatter_px2 = squares / std::max(1.0, 2.0 * weights - 6.0);
    if (!equations.step(best.motion)) return std::nullopt;
  }
  bool solved = false;
  best.covariance = equations.a.inv(cv::DECOMP_CHOLESKY, &solved) * scatter_px2;
  if (!solved) return std::nullopt;
  return best;
}

std::optional<ShiftResult> solve_disparity_shift(std::span<const FollowedCorner> corners, const Pinhole& camera,
                                                 double scale_px_m, const CameraMotion& start,
                                                 const EgoOptions& options) {
  constexpr int kSteps = 12;
  constexpr double kWide = 4.0, kNarrowing = 0.6;  // of the limit, which first takes in what a shift throws off
  constexpr double kSettled_px = 0.01;
  constexpr double kMinDisparity_px = 0.5;
  CameraMotion motion = start;
  ShiftResult result;
  for (int iteration = 0; iteration < kSteps; ++iteration) {
    const double widening = std::max(1.0, kWide * std::pow(kNarrowing, iteration));
    const double limit_px = options.max_residual_px * widening;
    NormalEquations<7> equations;
    double weights = 0.0, squares = 0.0;
    result.agreeing = 0;
    for (const auto& [before_m, now_px] : corners) {
      const double seen_px = scale_px_m / before_m[2], true_px = seen_px + result.shift_px;
      if (true_px < kMinDisparity_px) continue;
      const Residual r = residual_of({before_m * (seen_px / true_px), now_px}, camera, motion);
      const double weight = weight_of(r, limit_px);
      if (weight == 0.0) continue;
      equations.add(r, camera, weight, {r.turned * (-1.0 / true_px)});
      weights += weight;
      squares += weight * r.px.dot(r.px);
      ++result.agreeing;
    }
    const auto change = equations.step(motion);
    if (!change) return std::nullopt;
    result.shift_px += (*change)[6];
    const double scatter_px2 = squares / std::max(1.0, 2.0 * weights - 7.0);
    result.deviation_px = std::sqrt(equations.a.inv(cv::DECOMP_CHOLESKY)(6, 6) * scatter_px2);
    if (widening == 1.0 && std::abs((*change)[6]) < kSettled_px) break;
  }
  return result;
}

}  // namespace flies::ego
