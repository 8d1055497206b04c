#include "flies/concentrate/concentrate.hpp"

#include <algorithm>

namespace flies {
namespace {

/// Flies outside the field (crossover may have borne them there) say nothing about obstacles: without fitness they
/// take part in nothing that follows.
Population silence_outsiders(Population flies, const RoadPlane& road, const FieldOptions& field) {
  for (std::size_t i = 0; i < flies.size(); ++i)
    if (!in_field(field, road, flies.point(i))) flies.fitness[i] = 0.0F;
  return flies;
}

std::vector<PixelPoint> project_samples(const std::vector<ViewAngle>& views, const Projection& projection,
                                        const RoadPlane& road) {
  std::vector<PixelPoint> pixels;
  for (const auto& view : views)
    for (const auto& sample : view.samples) {
      const auto image = projection.project({sample.x_m, sample.y_m, road.z_m(sample.x_m, sample.y_m)});
      pixels.push_back({image.u_px, image.v_px});
    }
  return pixels;
}

std::vector<Candidate> judge(const std::vector<PixelPoint>& centres, const std::vector<double>& density,
                             const Projection& projection, const RoadPlane& road, const ConcentrateOptions& options) {
  const double strongest = density.empty() ? 0.0 : *std::max_element(density.begin(), density.end());
  const double least = std::max(options.min_density, options.min_density_share * strongest);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const Point3 ground = projection.meet_road(centres[i].u_px, centres[i].v_px, road);
    candidates.push_back({centres[i], {ground.x_m, ground.y_m}, density[i], density[i] > 0.0 && density[i] >= least});
  }
  return candidates;
}

}  // namespace

ConcentrateResult concentrate(const Population& all_flies, const Projection& projection, const RoadPlane& road,
                              const FieldOptions& field, const ConcentrateOptions& options) {
  const auto flies = silence_outsiders(all_flies, road, field);
  auto sampling = sample_histograms(flies, field, options);
  const auto dropped = drop_flies(flies, projection, road);
  const auto starts = project_samples(sampling.view_angles, projection, road);
  auto shifted = shift_means(starts, dropped, options);
  std::vector<PixelPoint> ends;
  for (const auto& point : shifted) ends.push_back(point.end);
  const auto centres = cluster_points(ends, options.bandwidth_px);
  const auto density = fitness_density(centres, dropped, options.bandwidth_px);
  auto candidates = judge(centres, density, projection, road, options);
  auto assembly = assemble_obstacles(candidates, flies, dropped, projection, road, options);
  return {sampling.axis,         std::move(sampling.view_angles), std::move(shifted),
          std::move(candidates), std::move(assembly.obstacles),   std::move(assembly.obstacle_of_fly)};
}

}  // namespace flies
