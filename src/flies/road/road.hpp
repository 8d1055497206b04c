#pragma once

#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

struct RoadOptions {
  bool estimate = true;
  int probes = 300;
  double x_min_m = 4.0;
  double x_max_m = 25.0;
  double half_width_m = 5.0;
  double max_slope = 0.07;
  double max_bank = 0.05;
  double max_height_m = 0.2;
  double min_correlation = 0.55;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("estimate", self.estimate, "fit the road plane to the pair; false: the nominal ground z = 0");
    field("probes", self.probes, Range{10, 100000}, "places on the road where its height is measured");
    field("x_min_m", self.x_min_m, Range{0.1, 200}, "nearest probe ahead");
    field("x_max_m", self.x_max_m, Range{0.5, 500}, "farthest probe ahead");
    field("half_width_m", self.half_width_m, Range{0.1, 50},
          "probes lie up to this far to each side of straight ahead");
    field("max_slope", self.max_slope, Range{0.0, 0.3}, "steepest road looked for, up or down, rise per metre");
    field("max_bank", self.max_bank, Range{0.0, 0.3}, "steepest bank accepted, rise per metre to the left");
    field("max_height_m", self.max_height_m, Range{0.0, 2.0}, "largest error of the camera height that is corrected");
    field("min_correlation", self.min_correlation, Range{0.0, 1.0}, "probes with a lower correlation are ignored");
  }
};

/// One place where the height of the road was looked for.
struct RoadProbe {
  Point3 point;              ///< best match along its line of sight, vehicle frame
  double correlation = 0.0;  ///< of the best match; 0 when it was poor or ambiguous, then the probe has no say
  bool inlier = false;       ///< on the fitted road
};

struct RoadResult {
  RoadPlane plane;
  std::vector<RoadProbe> probes;
  bool found = false;  ///< false: too few probes agreed, or not asked for; `plane` is the nominal ground
};

/// @throws InputError naming `source` and an option out of its range, or the probed stretch when it is empty
void check_road_options(const RoadOptions& options, const std::string& source);

/// Estimates the road plane from the pair. Each probe, a point of the left image that would show the nominal road, is
/// matched along its line of sight over the disparities that a road of any allowed slope could have. What is matched
/// may also be an obstacle, but nothing lies below a road: the plane that has most matches on it and fewest below it
/// starts a robust fit of height, slope and bank. Deterministic; needs no random numbers.
RoadResult estimate_road(const RectifiedPair& pair, const Projection& projection, const RoadOptions& options);

}  // namespace flies
