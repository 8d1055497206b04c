#pragma once

#include <span>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/scan.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

struct WholeOptions {
  bool enable = true;
  double step_m = 0.3;
  double step_share = 0.03;
  double depth_m = 5.0;
  double join_depth_m = 1.0;
  double max_width_m = 8.0;
  double gap_m = 0.3;
  double min_new_width_m = 1.0;
  double min_new_confidence = 0.9;
  double max_new_range_m = 25.0;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("enable", self.enable, "widen and join obstacles along the surfaces of the scan, and add what it alone sees");
    field("step_m", self.step_m, Range{0, 10}, "largest step in range between neighbouring sectors of one surface");
    field("step_share", self.step_share, Range{0, 1}, "added to step_m: this share of the range");
    field("depth_m", self.depth_m, Range{0, 100}, "an obstacle reaches this far behind its near face");
    field("join_depth_m", self.join_depth_m, Range{0, 100},
          "obstacles whose near faces are farther apart in range are not joined");
    field("max_width_m", self.max_width_m, Range{0.1, 100}, "obstacles grow and are joined up to this width");
    field("gap_m", self.gap_m, Range{0, 10}, "obstacles on one surface are joined across gaps up to this");
    field("min_new_width_m", self.min_new_width_m, Range{0, 100},
          "narrower surfaces that no fly is on do not become obstacles");
    field("min_new_confidence", self.min_new_confidence, Range{0, 1.01},
          "nor do surfaces whose sectors have a lower mean confidence; above 1: no surface becomes one");
    field("max_new_range_m", self.max_new_range_m, Range{0, 1000}, "nor do surfaces farther away than this");
  }
};

/// Makes whole things of obstacles: each grows sideways along the surface of the scan that it stands on, those that
/// meet on one surface become one, and surfaces that no obstacle stands on become obstacles of their own (score 0).
/// @param obstacles  from the flies
/// @param scan       of the same pair; empty: the obstacles are returned as they are
/// @returns nearest first
/// @throws InputError naming an option out of its range
std::vector<Obstacle> whole_obstacles(std::span<const Obstacle> obstacles, const Scan& scan,
                                      const Projection& projection, const RoadPlane& road, const WholeOptions& options);

}  // namespace flies
