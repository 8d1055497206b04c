#pragma once

#include <span>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/eval/truth.hpp"

namespace flies {

/// When an obstacle and the truth agree (docs/evaluation.md). Distances are horizontal.
struct MatchOptions {
  double radius_m = 0.75;
  double radius_per_range = 0.05;
  double min_range_m = 5.0;
  double max_range_m = 40.0;
  int min_lidar_points = 3;
  double min_above_road_m = 0.35;
  double max_above_road_m = 2.3;

  double radius_at_m(double range_m) const { return radius_m + radius_per_range * range_m; }

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("radius_m", self.radius_m, Range{0, 10},
          "an obstacle agrees with truth that is within this distance, metres, plus radius_per_range times its range");
    field("radius_per_range", self.radius_per_range, Range{0, 1}, "this share of its range is added to radius_m");
    field("min_range_m", self.min_range_m, Range{0, 1000}, "nearest labelled objects to be found, metres");
    field("max_range_m", self.max_range_m, Range{0, 1000}, "farthest labelled objects to be found, metres");
    field("min_lidar_points", self.min_lidar_points, Range{1, 1000}, "lidar returns needed to confirm an obstacle");
    field("min_above_road_m", self.min_above_road_m, Range{0, 10},
          "lowest lidar return that counts, metres above the road");
    field("max_above_road_m", self.max_above_road_m, Range{0, 10},
          "highest lidar return that counts, metres above the road");
  }
};

/// What the truth says about one reported obstacle.
struct ObstacleVerdict {
  double range_m = 0.0;         ///< as reported
  bool right = false;           ///< something stands there: by lidar, or where there is none by any label
  int object = -1;              ///< index of the labelled object it was reported for, -1 when it is near none
  double near_range_m = 0.0;    ///< of that object's near face in the obstacle's direction; meaningful with an object
  double range_error_m = 0.0;   ///< obstacle's range minus `near_range_m`: positive when reported too far
  double width_error_m = 0.0;   ///< reported minus labelled, across the line of sight
  double depth_error_m = 0.0;   ///< reported minus labelled: of the faces turned to us, along the line of sight
  double height_error_m = 0.0;  ///< reported minus labelled
};

/// What was made of one labelled object.
struct ObjectVerdict {
  bool counted = false;  ///< visible and in the range that is asked for
  bool found = false;    ///< an obstacle lies within the matching radius of its footprint
  int reports = 0;       ///< obstacles reported for it; more than one: duplicates
};

/// Verdicts of one frame, in the order of its obstacles and of the truth's objects.
struct FrameScore {
  std::vector<ObstacleVerdict> obstacles;
  std::vector<ObjectVerdict> objects;
  bool has_lidar = false;
};

/// Scores the obstacles that any detector reported for one pair.
/// Each obstacle is reported for the one object whose footprint is nearest, if within the radius at its range. Its
/// range error is against `near_face_m`.
FrameScore score_frame(const FrameTruth& truth, std::span<const Obstacle> obstacles, const MatchOptions& options = {});

/// Range of the object's near face in a direction: where the lidar saw it (10th percentile range of its returns close
/// to that direction, or of all its returns), otherwise where the ray meets the labelled box, otherwise the box's
/// nearest point.
double near_face_m(const FrameTruth& truth, const LabelledObject& object, double azimuth_rad);

/// Pedestrians as obstacles, so that verdicts of a classifier can be scored as well.
std::vector<Obstacle> as_obstacles(std::span<const Pedestrian> pedestrians);

}  // namespace flies
