#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "flies/concentrate/concentrate.hpp"
#include "flies/concentrate/kernels/kernel_sums.hpp"
#include "flies/concentrate/steps.hpp"
#include "flies/core/error.hpp"
#include "flies/core/options.hpp"

namespace flies {
namespace {

/// A shift shorter than this ends the iterations early.
constexpr double kConverged_px = 0.01;

/// Points a task: some ten microseconds of work.
constexpr std::size_t kPointsPerTask = 32;

/// The flies under a kernel of bandwidth h at p.
kernels::KernelSums sum_kernel(const PixelGrid& flies, const PixelPoint& p, double h) {
  return kernels::sum_kernel(flies.near(p, kernels::kKernelReach * h), p.u_px, p.v_px, h);
}

/// Where a point arrives that is moved to the mean of the flies around it again and again.
PixelPoint shift_mean(const PixelGrid& flies, double bandwidth_px, int iterations, PixelPoint p) {
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const auto sums = sum_kernel(flies, p, bandwidth_px);
    if (sums.weight <= 0.0) break;
    // p <- sum w_i p_i with weights that add up to 1, written as a step from p.
    const double du = sums.du_px / sums.weight, dv = sums.dv_px / sums.weight;
    p = {p.u_px + du, p.v_px + dv};
    if (du * du + dv * dv < kConverged_px * kConverged_px) break;
  }
  return p;
}

DroppedFly drop(const Projection& projection, const RoadPlane& road, double x_m, double y_m, double fitness) {
  const Point3 foot{x_m, y_m, road.z_m(x_m, y_m)};
  if (!(projection.depth_m(foot) > 0.0)) return {};
  const auto image = projection.project(foot);
  return {{image.u_px, image.v_px}, fitness};
}

PixelGrid fill_grid(const std::vector<DroppedFly>& flies, double bandwidth_px) {
  PixelGrid grid;
  grid.fill(flies, kernels::kKernelReach * bandwidth_px);
  return grid;
}

}  // namespace

void drop_flies(const Sightings& flies, const Projection& projection, const RoadPlane& road,
                std::vector<DroppedFly>& dropped) {
  dropped.resize(flies.size());
  for (std::size_t i = 0; i < flies.size(); ++i)
    dropped[i] = drop(projection, road, flies.x_m[i], flies.y_m[i], flies.fitness[i]);
}

std::vector<DroppedFly> drop_flies(const Population& flies, const Projection& projection, const RoadPlane& road) {
  std::vector<DroppedFly> dropped(flies.size());
  for (std::size_t i = 0; i < flies.size(); ++i)
    dropped[i] = drop(projection, road, flies.x_m[i], flies.y_m[i], flies.fitness[i]);
  return dropped;
}

void shift_means(const PixelGrid& flies, const ConcentrateOptions& options, std::span<ShiftedPoint> points) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), kPointsPerTask), [&](const auto& part) {
    for (auto& point : points.subspan(part.begin(), part.size()))
      point.end = shift_mean(flies, options.bandwidth_px, options.iterations, point.start);
  });
}

std::vector<ShiftedPoint> shift_means(const std::vector<PixelPoint>& starts, const std::vector<DroppedFly>& flies,
                                      const ConcentrateOptions& options) {
  check_options(options, "concentrate options");
  std::vector<ShiftedPoint> points;
  points.reserve(starts.size());
  for (const auto& start : starts) points.push_back({start, start});
  shift_means(fill_grid(flies, options.bandwidth_px), options, points);
  return points;
}

void find_density(std::span<const PixelPoint> points, const PixelGrid& flies, std::size_t population,
                  double bandwidth_px, std::vector<double>& density) {
  density.clear();
  for (const auto& p : points)
    density.push_back(population == 0 ? 0.0
                                      : sum_kernel(flies, p, bandwidth_px).weight / static_cast<double>(population));
}

std::vector<double> fitness_density(const std::vector<PixelPoint>& points, const std::vector<DroppedFly>& flies,
                                    double bandwidth_px) {
  if (!(std::isfinite(bandwidth_px) && bandwidth_px > 0.0))
    throw InputError("fitness_density", "bandwidth_px",
                     "found " + detail::double_text(bandwidth_px) + ", expected a number above 0");
  std::vector<double> density;
  find_density(points, fill_grid(flies, bandwidth_px), flies.size(), bandwidth_px, density);
  return density;
}

}  // namespace flies
