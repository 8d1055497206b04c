#include "flies/road/road.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "flies/core/convert.hpp"
#include "flies/core/error.hpp"
#include "flies/core/usable_pair.hpp"
#include "flies/road/correlate_disparities.hpp"
#include "flies/road/kernels/correlate_shifts.hpp"

namespace flies {
namespace {

/// Probes that must agree before their fit replaces the nominal ground.
constexpr int kMinInliers = 15;

/// Distance in disparity that counts as lying on the plane.
constexpr double kInlierDisparity_px = 0.75;

/// Disparities of a probe that are looked through at most: more than any image is wide.
constexpr double kMaxSpan_px = 100'000;
constexpr double kLeastSpan_px = 2.0;

/// Standard deviations that weigh the measurements against the prior "nominal ground" in the fit: of a probe's
/// disparity, of the error in the camera's height, and of the road's bank.
constexpr double kDisparityNoise_px = 0.5;
constexpr double kPriorHeight_m = 0.03;
constexpr double kPriorBank = 0.01;

/// The slopes that are tried up, and as many down: many more than any camera tells apart.
constexpr int kMaxSlopeSteps = 1000;

constexpr std::size_t kProbesPerTask = 32;

/// Probes along rows that are evenly spaced in the image from the far to the near edge of the probed stretch.
std::vector<StereoPoint> place_probes(const RectifiedPair& pair, const Projection& projection,
                                      const RoadOptions& options) {
  const int columns = std::max(2, static_cast<int>(std::sqrt(options.probes / 2.0)));
  const int rows = std::max(2, options.probes / columns);
  std::vector<StereoPoint> probes;
  for (int r = 0; r < rows; ++r) {
    const double inverse_x = std::lerp(1.0 / options.x_max_m, 1.0 / options.x_min_m, (r + 0.5) / rows);
    for (int c = 0; c < columns; ++c) {
      // Every other row is shifted by half a column so that the probes do not line up with the road's markings.
      const double across = (c + (r % 2 == 0 ? 0.25 : 0.75)) / columns;
      const Point3 nominal{1.0 / inverse_x, std::lerp(-options.half_width_m, options.half_width_m, across), 0.0};
      const auto image = projection.project(nominal);
      if (image.u_px >= 0 && image.u_px < pair.left.width_px && image.v_px >= 0 && image.v_px < pair.left.height_px)
        probes.push_back(image);
    }
  }
  return probes;
}

/// Has the rows around a probe and around its match on the nominal road fetched: the road is the first to touch a pair,
/// and waiting for memory would be half of its time.
void prefetch(const RectifiedPair& pair, const StereoPoint& image) {
  constexpr int kHalfHeight = kernels::kShiftRows / 2;
  const int u = static_cast<int>(image.u_px), v = static_cast<int>(image.v_px);
  const int right_u = std::clamp(static_cast<int>(image.u_px - image.disparity_px), 0, pair.right.width_px - 1);
  for (int row = std::max(0, v - kHalfHeight); row <= std::min(pair.left.height_px - 1, v + kHalfHeight); ++row) {
    __builtin_prefetch(pair.left.row(row) + u);
    __builtin_prefetch(pair.right.row(row) + right_u);
  }
}

/// Matches one probe along its line of sight, in steps of one pixel of disparity and then between them.
/// @param correlation memory
RoadProbe match_probe(const RectifiedPair& pair, const Projection& projection, const RoadOptions& options,
                      const StereoPoint& image, std::vector<float>& correlation) {
  const auto disparity_on_slope = [&](double slope) {
    const Point3 point = projection.meet_road(image.u_px, image.v_px, {0.0, slope, 0.0});
    return point.x_m > 0.0 ? projection.disparity_at_depth(projection.depth_m(point))
                           : projection.disparity_offset_px();
  };
  const double downhill_px = disparity_on_slope(-options.max_slope), uphill_px = disparity_on_slope(options.max_slope);
  // From high up all slopes are within a pixel or two, and a peak needs room.
  const double slack_px = uphill_px - downhill_px < kLeastSpan_px ? 1.0 : 0.0;
  const double lowest_px = downhill_px - slack_px;
  // Farther to the left than the image begins no match lies.
  const double highest_px = std::min(uphill_px + slack_px, image.u_px);
  if (!(highest_px - lowest_px >= kLeastSpan_px && highest_px - lowest_px <= kMaxSpan_px)) return {};
  correlation.resize(static_cast<std::size_t>(highest_px - lowest_px) + 1);
  correlate_disparities(pair, image, lowest_px, correlation);

  const double best = unambiguous_best(correlation, options.min_correlation);
  if (best < 0.0) return {};
  const double disparity_px = lowest_px + best;
  return {projection.triangulate({image.u_px, image.v_px, disparity_px}),
          correlation[static_cast<std::size_t>(std::lrint(best))], false};
}

/// Solves the 3 x 3 normal equations of z = height + slope x + bank y by Gaussian elimination; they are positive
/// definite thanks to the prior.
std::array<double, 3> solve(std::array<std::array<double, 4>, 3> m) {
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t row = k + 1; row < 3; ++row) {
      const double factor = m[row][k] / m[k][k];
      for (std::size_t column = k; column < 4; ++column) m[row][column] -= factor * m[k][column];
    }
  std::array<double, 3> x{};
  for (std::size_t k = 3; k-- > 0;) {
    x[k] = m[k][3];
    for (std::size_t column = k + 1; column < 3; ++column) x[k] -= m[k][column] * x[column];
    x[k] /= m[k][k];
  }
  return x;
}

/// Change of disparity per metre that a point of the road is off its plane along its line of sight: the factor that
/// turns height errors into the measurement's own unit, in which near and far probes compare.
double disparity_per_height(const Projection& projection, const Point3& point) {
  const double parallax = projection.disparity_at_depth(projection.depth_m(point)) - projection.disparity_offset_px();
  return parallax / projection.height_m();
}

/// Iteratively reweighted least squares with Tukey's weights, and a prior that holds what few probes leave open.
RoadPlane fit_plane(const Projection& projection, std::vector<RoadProbe>& probes, RoadPlane plane) {
  constexpr int kIterations = 6;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::array<std::array<double, 4>, 3> normal{};
    normal[0][0] = 1.0 / (kPriorHeight_m * kPriorHeight_m);
    normal[1][1] = 1e-9;
    normal[2][2] = 1.0 / (kPriorBank * kPriorBank);
    for (auto& probe : probes) {
      const Point3& p = probe.point;
      const double scale = disparity_per_height(projection, p);
      const double error_px = scale * (p.z_m - plane.z_m(p.x_m, p.y_m));
      probe.inlier = probe.correlation > 0.0 && std::abs(error_px) < kInlierDisparity_px;
      if (!probe.inlier) continue;
      const double closeness = 1.0 - std::pow(error_px / kInlierDisparity_px, 2);
      const double weight = std::pow(closeness * scale / kDisparityNoise_px, 2);
      const std::array<double, 3> row{1.0, p.x_m, p.y_m};
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b) normal[a][b] += weight * row[a] * row[b];
        normal[a][3] += weight * row[a] * p.z_m;
      }
    }
    const auto [height_m, slope, bank] = solve(normal);
    plane = {height_m, slope, bank};
  }
  return plane;
}

/// Where a probe matched, beside the road.
struct Match {
  double x_m, y_m, z_m;
  double disparity_per_height;
};

/// Matches on the plane less matches below it. Below a road there is nothing, above it there are obstacles.
int support(const std::vector<Match>& matches, const RoadPlane& plane) {
  int result = 0;
  for (const auto& match : matches) {
    const double error_px = match.disparity_per_height * (match.z_m - plane.z_m(match.x_m, match.y_m));
    result +=
        static_cast<int>(std::abs(error_px) < kInlierDisparity_px) - static_cast<int>(error_px <= -kInlierDisparity_px);
  }
  return result;
}

/// The best supported slope, in steps of half a pixel of disparity.
RoadPlane search_slopes(const Projection& projection, const std::vector<RoadProbe>& probes, double max_slope) {
  const double finest =
      0.5 * projection.height_m() / (projection.disparity_at_depth(1.0) - projection.disparity_offset_px());
  const double step = std::max(finest, max_slope / kMaxSlopeSteps);
  const int steps = std::min(kMaxSlopeSteps, saturated<int>(max_slope / step));
  std::vector<Match> matches;
  for (const auto& [point, correlation, inlier] : probes)
    if (correlation > 0.0)
      matches.push_back({point.x_m, point.y_m, point.z_m, disparity_per_height(projection, point)});
  RoadPlane best;
  int best_support = support(matches, best);
  for (int s = -steps; s <= steps; ++s) {
    const RoadPlane plane{0.0, s * step, 0.0};
    if (const int plane_support = support(matches, plane); plane_support > best_support) {
      best = plane;
      best_support = plane_support;
    }
  }
  return best;
}

}  // namespace

void check_road_options(const RoadOptions& options, const std::string& source) {
  check_options(options, source);
  if (!(options.x_min_m < options.x_max_m))
    throw InputError(source, "road.x_min_m",
                     fmt::format("the interval {}..{} m is empty", options.x_min_m, options.x_max_m));
}

RoadResult estimate_road(const RectifiedPair& given, const Projection& projection, const RoadOptions& options) {
  const RectifiedPair pair = detail::usable_pair(given);
  check_road_options(options, "road options");
  RoadResult result;
  if (!options.estimate) return result;
  const auto places = place_probes(pair, projection, options);
  result.probes.resize(places.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, places.size(), kProbesPerTask), [&](const auto& part) {
    std::vector<float> correlation;
    for (std::size_t i = part.begin(); i < part.end(); ++i) {
      if (i + 1 < part.end()) prefetch(pair, places[i + 1]);
      result.probes[i] = match_probe(pair, projection, options, places[i], correlation);
    }
  });

  const auto start = search_slopes(projection, result.probes, options.max_slope);
  const auto plane = fit_plane(projection, result.probes, start);
  const auto inliers = std::count_if(result.probes.begin(), result.probes.end(), [](auto& p) { return p.inlier; });
  result.found = inliers >= kMinInliers && std::abs(plane.height_m) <= options.max_height_m &&
                 std::abs(plane.slope) <= options.max_slope && std::abs(plane.bank) <= options.max_bank;
  if (result.found) result.plane = plane;
  return result;
}

}  // namespace flies
