#include "flies/concentrate/concentrate.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>

#include "flies/concentrate/kernels/kernel_sums.hpp"
#include "flies/concentrate/steps.hpp"

namespace flies {
namespace {

void project_samples(const std::vector<ViewAngle>& views, const Projection& projection, const RoadPlane& road,
                     std::vector<ShiftedPoint>& points) {
  points.clear();
  for (const auto& view : views)
    for (const auto& sample : view.samples) {
      const Point3 foot{sample.x_m, sample.y_m, road.z_m(sample.x_m, sample.y_m)};
      if (!(projection.depth_m(foot) > 0.0)) continue;
      const auto image = projection.project(foot);
      points.push_back({.start = {image.u_px, image.v_px}, .end = {}});
    }
}

void judge(const std::vector<PixelPoint>& centres, const std::vector<double>& density, const Projection& projection,
           const RoadPlane& road, const ConcentrateOptions& options, std::vector<Candidate>& candidates) {
  const double strongest = density.empty() ? 0.0 : *std::max_element(density.begin(), density.end());
  const double least = std::max(options.min_density, options.min_density_share * strongest);
  candidates.clear();
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const Point3 ground = projection.meet_road(centres[i].u_px, centres[i].v_px, road);
    candidates.push_back({centres[i], {ground.x_m, ground.y_m}, density[i], density[i] > 0.0 && density[i] >= least});
  }
}

}  // namespace

/// Room for every fly to have a say and for every sample point to become an obstacle.
void Concentrator::reserve(std::size_t flies, const ConcentrateOptions& options) {
  sighter_.reserve(flies);
  sightings_.reserve(flies);
  dropped_.reserve(flies);
  grid_.reserve(flies);
  result_.obstacle_of_fly.reserve(flies);
  const std::size_t points = count_view_angles(options) * static_cast<std::size_t>(options.samples);
  result_.shifted.reserve(points);
  ends_.reserve(points);
  clustering_.reserve(points);
  density_.reserve(points);
  result_.candidates.reserve(points);
  assembler_.reserve(flies, points);
  result_.obstacles.reserve(points);
}

const ConcentrateResult& Concentrator::concentrate(const Population& flies, const Projection& projection,
                                                   const RoadPlane& road, const FieldOptions& field,
                                                   const ConcentrateOptions& options) {
  check_options(options, "concentrate options");
  check_field(field, "field options");
  auto& [axis, view_angles, shifted, candidates, obstacles, obstacle_of_fly] = result_;
  reserve(flies.size(), options);
  sighter_.sight(flies, road, field, sightings_);
  tbb::parallel_invoke(
      [&] {
        sample_histograms(sightings_, field, options, fullest_, axis, view_angles);
        project_samples(view_angles, projection, road, shifted);
      },
      [&] {
        drop_flies(sightings_, projection, road, dropped_);
        grid_.fill(dropped_, kernels::kKernelReach * options.bandwidth_px);
      });
  shift_means(grid_, options, shifted);
  ends_.clear();
  for (const auto& point : shifted) ends_.push_back(point.end);
  const auto& centres = clustering_.cluster(ends_, options.bandwidth_px);
  find_density(centres, grid_, flies.size(), options.bandwidth_px, density_);
  judge(centres, density_, projection, road, options, candidates);
  assembler_.assemble(candidates, sightings_, grid_, flies.size(), projection, road, options, obstacles,
                      obstacle_of_fly);
  return result_;
}

ConcentrateResult concentrate(const Population& flies, const Projection& projection, const RoadPlane& road,
                              const FieldOptions& field, const ConcentrateOptions& options) {
  return Concentrator().concentrate(flies, projection, road, field, options);
}

}  // namespace flies
