#include "flies/road/ground_plane.hpp"

#include <algorithm>
#include <array>

#include "flies/core/matrix3.hpp"
#include "flies/core/quantile.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

/// Distance in disparity that counts as lying on a plane. Where the ground comes nearer quickly from row to row, the
/// neighbourhoods that are matched cover several disparities and their match is as uncertain.
constexpr double kInlier_px = 0.6;
/// With less focal length times baseline the ground spans so few disparities that a plane takes floor and walls for
/// one: the distance shrinks with it, but not below what disparities scatter by.
constexpr double kScaleOfInlier_px_m = 32.0, kLeastInlier_px = 0.25;

/// Nearer to the horizon than this parallax everything is on the ground.
constexpr double kLeastParallax_px = 1.5;

/// By which disparities of places beside each other are off together: soft texture, slanted neighbourhoods.
constexpr double kBias_px = 0.05;

constexpr int kTrials = 20'000;
/// Of the trials so many are refined, the best supported.
constexpr std::size_t kRefined = 12;
constexpr std::uint64_t kSeed = 14;

double tolerance_px(const SeenPlaces& seen, const GroundPlane& plane) {
  const double share = std::clamp(seen.scale_px_m / kScaleOfInlier_px_m, kLeastInlier_px / kInlier_px, 1.0);
  return kInlier_px * share * std::max(1.0, std::abs(plane.down_px) / seen.fy_px);
}

/// @returns nothing when the matrix is singular for practical purposes
std::optional<Matrix3> inverse(const Matrix3& m) {
  const double d = determinant(m);
  if (!(std::abs(d) > 1e-12)) return std::nullopt;
  Matrix3 result;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, e = (i + 2) % 3;
      result[i][j] = (m[a][c] * m[b][e] - m[a][e] * m[b][c]) / d;
    }
  return result;
}

std::array<double, 3> row_of(const SeenPlace& place) { return {place.across, place.down, 1.0}; }

GroundPlane times(const Matrix3& m, const std::array<double, 3>& x) {
  const auto line = [&](std::size_t i) { return m[i][0] * x[0] + m[i][1] * x[1] + m[i][2] * x[2]; };
  return {line(0), line(1), line(2)};
}

/// The plane through three places.
std::optional<GroundPlane> plane_through(const std::array<const SeenPlace*, 3>& p) {
  const auto inverted = inverse({row_of(*p[0]), row_of(*p[1]), row_of(*p[2])});
  if (!inverted) return std::nullopt;
  return times(*inverted, {p[0]->parallax_px, p[1]->parallax_px, p[2]->parallax_px});
}

/// The plane through two places that is level from side to side, as most are.
std::optional<GroundPlane> level_plane_through(const SeenPlace& a, const SeenPlace& b) {
  const double rows = b.down - a.down;
  if (std::abs(rows) < 1e-6) return std::nullopt;
  const double down_px = (b.parallax_px - a.parallax_px) / rows;
  return GroundPlane{0.0, down_px, a.parallax_px - down_px * a.down};
}

/// Normal equations of the places on a plane, with Tukey's weights.
struct NormalEquations {
  Matrix3 matrix{};
  std::array<double, 3> right{};
  double squares = 0.0, weight = 0.0;

  NormalEquations(const SeenPlaces& seen, const GroundPlane& plane, double tolerance) {
    for (const auto& place : seen.places) {
      const double on_plane_px = plane.parallax_px(place);
      const double error_px = place.parallax_px - on_plane_px;
      if (on_plane_px < kLeastParallax_px || std::abs(error_px) >= tolerance) continue;
      const double w = std::pow(1.0 - std::pow(error_px / tolerance, 2), 2);
      const auto row = row_of(place);
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b) matrix[a][b] += w * row[a] * row[b];
        right[a] += w * row[a] * place.parallax_px;
      }
      squares += w * error_px * error_px;
      weight += w;
    }
  }
};

GroundPlane refined(const SeenPlaces& seen, GroundPlane plane) {
  for (const double widening : {2.0, 1.5, 1.0, 1.0}) {
    const NormalEquations normal(seen, plane, widening * tolerance_px(seen, plane));
    const auto inverted = inverse(normal.matrix);
    if (!inverted) return plane;
    plane = times(*inverted, normal.right);
  }
  return plane;
}

bool by_support(const SupportedPlane& a, const SupportedPlane& b) { return a.support > b.support; }

}  // namespace

bool MountLimits::allow(const CameraMount& mount) const {
  return mount.height_m >= min_height_m && mount.height_m <= max_height_m && mount.pitch_rad >= min_pitch_rad &&
         mount.pitch_rad <= max_pitch_rad && mount.roll_rad >= min_roll_rad && mount.roll_rad <= max_roll_rad;
}

CameraMount mount_above(const GroundPlane& plane, double scale_px_m) {
  const double length = std::hypot(plane.across_px, plane.down_px, plane.ahead_px);
  return {scale_px_m / length, std::asin(plane.ahead_px / length), std::atan2(plane.across_px, plane.down_px)};
}

GroundPlane plane_below(const CameraMount& mount, double scale_px_m) {
  // The way straight down, in the camera's axes, over the height.
  const double over_height = scale_px_m / mount.height_m;
  return {over_height * std::cos(mount.pitch_rad) * std::sin(mount.roll_rad),
          over_height * std::cos(mount.pitch_rad) * std::cos(mount.roll_rad), over_height * std::sin(mount.pitch_rad)};
}

double ground_support(const SeenPlaces& seen, const GroundPlane& plane) {
  const double tolerance = tolerance_px(seen, plane);
  double support = 0.0;
  for (const auto& place : seen.places) {
    const double on_plane_px = plane.parallax_px(place);
    if (on_plane_px < kLeastParallax_px) continue;
    const double error = (place.parallax_px - on_plane_px) / tolerance;
    if (error < 1.0) support += std::max(-1.0, 1.0 - error * error);
  }
  return support;
}

std::optional<SupportedPlane> fit_ground(const SeenPlaces& seen, const MountLimits& limits,
                                         std::span<const GroundPlane> first) {
  const auto count = static_cast<std::uint32_t>(seen.places.size());
  if (count < 3) return std::nullopt;
  std::vector<SupportedPlane> best;
  const auto consider = [&](const GroundPlane& plane) {
    if (!limits.allow(mount_above(plane, seen.scale_px_m))) return;
    const double support = ground_support(seen, plane);
    if (best.size() == kRefined && support <= best.back().support) return;
    if (best.size() == kRefined) best.pop_back();
    const SupportedPlane supported{plane, support};
    best.insert(std::upper_bound(best.begin(), best.end(), supported, by_support), supported);
  };
  for (const auto& plane : first) consider(plane);
  FlyRandom random(kSeed, 0, 0, 0);
  for (int trial = 0; trial < kTrials; ++trial) {
    std::array<const SeenPlace*, 3> three{};
    for (auto& place : three) place = &seen.places[random.below(count)];
    if (trial % 2 == 0) {
      if (const auto plane = level_plane_through(*three[0], *three[1])) consider(*plane);
    } else if (const auto plane = plane_through(three)) {
      consider(*plane);
    }
  }
  std::optional<SupportedPlane> found;
  for (const auto& candidate : best) {
    const GroundPlane plane = refined(seen, candidate.plane);
    const double support = ground_support(seen, plane);
    const bool is_better = support >= candidate.support && limits.allow(mount_above(plane, seen.scale_px_m));
    const SupportedPlane kept = is_better ? SupportedPlane{plane, support} : candidate;
    if (kept.support > 0.0 && (!found || kept.support > found->support)) found = kept;
  }
  return found;
}

double depth_ratio_on(const SeenPlaces& seen, const GroundPlane& plane) {
  const double tolerance = tolerance_px(seen, plane);
  std::vector<double> parallaxes_px;
  for (const auto& place : seen.places) {
    const double on_plane_px = plane.parallax_px(place);
    if (on_plane_px >= kLeastParallax_px && std::abs(place.parallax_px - on_plane_px) < tolerance)
      parallaxes_px.push_back(on_plane_px);
  }
  if (parallaxes_px.empty()) return 1.0;
  return quantile(parallaxes_px, 0.9) / quantile(parallaxes_px, 0.1);
}

MountDeviation mount_deviation(const SeenPlaces& seen, const GroundPlane& plane) {
  const NormalEquations normal(seen, plane, tolerance_px(seen, plane));
  const auto covariance = inverse(normal.matrix);
  if (!covariance || normal.weight < 4.0) return {};
  // However many places there are, they make up for chance, not for what they are off by together.
  const double variance_px2 = normal.squares / (normal.weight - 3.0) + normal.weight * kBias_px * kBias_px;
  const CameraMount mount = mount_above(plane, seen.scale_px_m);
  // By differences: how far the mount moves with each number of the plane.
  std::array<CameraMount, 3> moved;
  const double step = 1e-4 * std::hypot(plane.across_px, plane.down_px, plane.ahead_px);
  moved[0] = mount_above({plane.across_px + step, plane.down_px, plane.ahead_px}, seen.scale_px_m);
  moved[1] = mount_above({plane.across_px, plane.down_px + step, plane.ahead_px}, seen.scale_px_m);
  moved[2] = mount_above({plane.across_px, plane.down_px, plane.ahead_px + step}, seen.scale_px_m);
  const auto deviation = [&](const auto& change) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        sum += (*covariance)[i][j] * (change(moved[i]) / step) * (change(moved[j]) / step);
    return std::sqrt(std::max(0.0, sum * variance_px2));
  };
  return {deviation([&](const CameraMount& m) { return m.height_m / mount.height_m - 1.0; }),
          deviation([&](const CameraMount& m) { return m.pitch_rad - mount.pitch_rad; }),
          deviation([&](const CameraMount& m) { return m.roll_rad - mount.roll_rad; })};
}

}  // namespace flies
