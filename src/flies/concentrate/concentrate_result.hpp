#pragma once

#include <vector>

#include "flies/core/ground_point.hpp"
#include "flies/core/results.hpp"

namespace flies {

/// A point of the left image.
struct PixelPoint {
  double u_px = 0.0;
  double v_px = 0.0;
};

/// A fly dropped to the ground and projected onto the left image (Li 2010, III.B), the element of the mean shift.
struct DroppedFly {
  PixelPoint pixel;
  double fitness = 0.0;
};

/// A view-angle of the histogram based sampling, its histogram and its sample points (Li 2010, III.B).
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

/// One sample point on its way through the mean shift (Li 2010, III.B), in the left image.
struct ShiftedPoint {
  PixelPoint start;
  PixelPoint end;
};

/// A cluster of shifted points (Li 2010, III.B) and what became of it.
struct Candidate {
  PixelPoint pixel;      ///< centre of the cluster in the left image (ground-dropped projection)
  GroundPoint ground;    ///< the same re-projected to the ground (Li 2010, III.B)
  double density = 0.0;  ///< fitness density at the centre (Li 2010, III.B)
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

}  // namespace flies
