#pragma once

#include <vector>

#include "flies/concentrate/concentrate_options.hpp"
#include "flies/core/field.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// A point on the ground of the vehicle frame.
struct GroundPoint {
  double x_m = 0.0;
  double y_m = 0.0;
};

/// A point of the left image.
struct PixelPoint {
  double u_px = 0.0;
  double v_px = 0.0;
};

/// A fly dropped to the ground and projected onto the left image (METHOD 4.2), the element of the mean shift.
struct DroppedFly {
  PixelPoint pixel;
  double fitness = 0.0;
};

/// A view-angle of the histogram based sampling, its histogram and its sample points (METHOD 4.1).
struct ViewAngle {
  double min_azimuth_rad = 0.0;  ///< its right edge; azimuth = atan2(y, x), positive to the left
  double max_azimuth_rad = 0.0;
  std::vector<double> votes;         ///< summed fitness per interval of x, see `HistogramAxis`
  std::vector<GroundPoint> samples;  ///< centres of the fullest intervals, on the view-angle's axis; fullest first
};

/// The intervals along x shared by all view-angles: interval k covers [min + k * bin, min + (k + 1) * bin).
struct HistogramAxis {
  double min_m = 0.0;
  double bin_m = 0.5;
  int bins = 0;
};

/// One sample point on its way through the mean shift (METHOD 4.2), in the left image.
struct ShiftedPoint {
  PixelPoint start;
  PixelPoint end;
};

/// A cluster of shifted points (METHOD 4.3) and what became of it.
struct Candidate {
  PixelPoint pixel;      ///< centre of the cluster in the left image (ground-dropped projection)
  GroundPoint ground;    ///< the same re-projected to the ground (METHOD 4.5)
  double density = 0.0;  ///< fitness density at the centre (METHOD 4.4)
  bool kept = false;     ///< false: discarded for its low density
};

/// Everything the concentrating step found, with all that is needed to draw and test it.
struct ConcentrateResult {
  HistogramAxis axis;
  std::vector<ViewAngle> view_angles;
  std::vector<ShiftedPoint> shifted;
  std::vector<Candidate> candidates;
  std::vector<Obstacle> obstacles;   ///< nearest first
  std::vector<int> obstacle_of_fly;  ///< per fly: index into `obstacles`, or -1
};

/// Condenses flies into obstacles (METHOD section "Concentrating"): the sum of the steps below.
/// @param flies scored flies; those outside the field of detection have no say
ConcentrateResult concentrate(const Population& flies, const Projection& projection, const RoadPlane& road,
                              const FieldOptions& field, const ConcentrateOptions& options);

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
std::vector<PixelPoint> cluster_points(const std::vector<PixelPoint>& points, double radius_px);

/// Step 4. Fitness density (1/n) sum f(p_i) exp(-|p_i - p|^2 / 2h^2) at each point.
std::vector<double> fitness_density(const std::vector<PixelPoint>& points, const std::vector<DroppedFly>& flies,
                                    double bandwidth_px);

/// Step 6, ours: gives each kept candidate its flies, measures position and size from them, and joins candidates that
/// are parts of one object. Fills `obstacles` and `obstacle_of_fly`.
struct Assembly {
  std::vector<Obstacle> obstacles;
  std::vector<int> obstacle_of_fly;
};
Assembly assemble_obstacles(const std::vector<Candidate>& candidates, const Population& flies,
                            const std::vector<DroppedFly>& dropped, const Projection& projection, const RoadPlane& road,
                            const ConcentrateOptions& options);

}  // namespace flies
