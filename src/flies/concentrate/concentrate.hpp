#pragma once

#include <cstddef>
#include <vector>

#include "flies/concentrate/assemble.hpp"
#include "flies/concentrate/clustering.hpp"
#include "flies/concentrate/concentrate_options.hpp"
#include "flies/concentrate/concentrate_result.hpp"
#include "flies/concentrate/pixel_grid.hpp"
#include "flies/concentrate/sightings.hpp"
#include "flies/core/field.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// Condenses flies into obstacles (Li 2010, III.B): the sum of the steps below.
/// @param flies scored flies; those outside the field of detection have no say
ConcentrateResult concentrate(const Population& flies, const Projection& projection, const RoadPlane& road,
                              const FieldOptions& field, const ConcentrateOptions& options);

/// The same for pair after pair. Keeps memory and nothing else from call to call: once it has seen a population of the
/// size, it allocates no more while the options stay. Threads: one object serves one thread at a time.
class Concentrator {
 public:
  /// @returns a result that is valid until the next call
  const ConcentrateResult& concentrate(const Population& flies, const Projection& projection, const RoadPlane& road,
                                       const FieldOptions& field, const ConcentrateOptions& options);

 private:
  void reserve(std::size_t flies, const ConcentrateOptions& options);

  FlySighter sighter_;
  Sightings sightings_;
  std::vector<std::size_t> fullest_;
  std::vector<DroppedFly> dropped_;
  PixelGrid grid_;
  std::vector<PixelPoint> ends_;
  Clustering clustering_;
  std::vector<double> density_;
  Assembler assembler_;
  ConcentrateResult result_;
};

/// Step 1. Histogram based sampling: per view-angle of `view_angle_deg` a histogram of the flies over x, votes weighted
/// by fitness; the fullest intervals give the sample points.
struct HistogramSampling {
  HistogramAxis axis;
  std::vector<ViewAngle> view_angles;
};
HistogramSampling sample_histograms(const Population& flies, const FieldOptions& field,
                                    const ConcentrateOptions& options);

/// Drops flies to the road and projects them onto the left image. One entry per fly, same order.
std::vector<DroppedFly> drop_flies(const Population& flies, const Projection& projection, const RoadPlane& road);

/// Step 2. Mean shift of every start towards the fitness-weighted density of the dropped flies, Gaussian kernel of
/// bandwidth `bandwidth_px`, `iterations` times.
std::vector<ShiftedPoint> shift_means(const std::vector<PixelPoint>& starts, const std::vector<DroppedFly>& flies,
                                      const ConcentrateOptions& options);

/// Step 3. Groups points that are chained by distances of at most `radius_px`. @returns the centre of each group
/// @throws InputError when the radius is not finite or not positive
std::vector<PixelPoint> cluster_points(const std::vector<PixelPoint>& points, double radius_px);

/// Step 4. Fitness density (1/n) sum f(p_i) exp(-|p_i - p|^2 / 2h^2) at each point.
/// @throws InputError when the bandwidth is not finite or not positive
std::vector<double> fitness_density(const std::vector<PixelPoint>& points, const std::vector<DroppedFly>& flies,
                                    double bandwidth_px);

}  // namespace flies
