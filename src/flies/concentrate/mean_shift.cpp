#include <algorithm>
#include <cmath>
#include <limits>

#include "flies/concentrate/concentrate.hpp"
#include "flies/concentrate/pixel_grid.hpp"

namespace flies {
namespace {

/// The Gaussian kernel is cut off where it has fallen to exp(-4.5) = 1 %: what lies beyond moves a mean by less than
/// a tenth of a pixel and would make every sample point visit every fly.
constexpr double kKernelReach = 3.0;

/// The kernel at a squared distance.
double kernel(double squared_px, double bandwidth_px) {
  const double bandwidths2 = squared_px / (bandwidth_px * bandwidth_px);
  return bandwidths2 > kKernelReach * kKernelReach ? 0.0 : std::exp(-0.5 * bandwidths2);
}

/// A shift shorter than this ends the iterations early.
constexpr double kConverged_px = 0.01;

}  // namespace

std::vector<DroppedFly> drop_flies(const Population& flies, const Projection& projection, const RoadPlane& road) {
  std::vector<DroppedFly> dropped(flies.size());
  for (std::size_t i = 0; i < flies.size(); ++i) {
    const Point3 foot{flies.x_m[i], flies.y_m[i], road.z_m(flies.x_m[i], flies.y_m[i])};
    if (!(projection.depth_m(foot) > 0.0)) continue;
    const auto image = projection.project(foot);
    dropped[i] = {{image.u_px, image.v_px}, flies.fitness[i]};
  }
  return dropped;
}

std::vector<ShiftedPoint> shift_means(const std::vector<PixelPoint>& starts, const std::vector<DroppedFly>& flies,
                                      const ConcentrateOptions& options) {
  const double h = options.bandwidth_px;
  const PixelGrid grid(flies, kKernelReach * h);
  std::vector<ShiftedPoint> shifted;
  for (const auto& start : starts) {
    PixelPoint p = start;
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
      double total = 0.0, u = 0.0, v = 0.0;
      grid.visit(p, [&](const DroppedFly& fly) {
        const double du = fly.pixel.u_px - p.u_px, dv = fly.pixel.v_px - p.v_px;
        const double w = fly.fitness * kernel(du * du + dv * dv, h);
        total += w;
        u += w * fly.pixel.u_px;
        v += w * fly.pixel.v_px;
      });
      if (total <= 0.0) break;
      const PixelPoint next{u / total, v / total};
      const double step_px = std::hypot(next.u_px - p.u_px, next.v_px - p.v_px);
      p = next;
      if (step_px < kConverged_px) break;
    }
    shifted.push_back({start, p});
  }
  return shifted;
}

std::vector<double> fitness_density(const std::vector<PixelPoint>& points, const std::vector<DroppedFly>& flies,
                                    double bandwidth_px) {
  const PixelGrid grid(flies, kKernelReach * bandwidth_px);
  std::vector<double> density;
  for (const auto& p : points) {
    double sum = 0.0;
    grid.visit(p, [&](const DroppedFly& fly) {
      const double du = fly.pixel.u_px - p.u_px, dv = fly.pixel.v_px - p.v_px;
      sum += fly.fitness * kernel(du * du + dv * dv, bandwidth_px);
    });
    density.push_back(flies.empty() ? 0.0 : sum / static_cast<double>(flies.size()));
  }
  return density;
}

}  // namespace flies
