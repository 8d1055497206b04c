#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/scan.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// A region of interest: where in the left image a person of this height would stand at this place.
/// The box has the detector's aspect 1:2 with its margin around the person (Li 2010, IV).
struct Roi {
  ImageBox window;   ///< what the classifier looks at, aspect 48:96; may reach beyond the image
  ImageBox person;   ///< head to feet inside the window
  double x_m = 0.0;  ///< foot point on the road, vehicle frame
  double y_m = 0.0;
  double height_m = 0.0;     ///< assumed height of the person
  std::size_t obstacle = 0;  ///< index of the obstacle it was proposed for; stretches of the scan come after them
};

struct ProposeOptions {
  double min_height_m = 1.3;
  double max_height_m = 1.9;
  int heights = 3;
  double lateral_margin_m = 0.2;
  double max_lateral_m = 1.0;
  int vertical_shifts = 1;
  double step = 0.0;
  double person_share = 0.75;
  double min_person_px = 45.0;
  double min_obstacle_height_m = 0.6;
  double min_stretch_m = 0.2;
  double merge_step = 0.05;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("min_height_m", self.min_height_m, Range{0.3, 3.0}, "smallest person looked for");
    field("max_height_m", self.max_height_m, Range{0.3, 3.0}, "tallest person looked for");
    field("heights", self.heights, Range{1, 32}, "heights tried from the smallest to the tallest, in equal ratios");
    field("lateral_margin_m", self.lateral_margin_m, Range{0.0, 2.0},
          "how far beyond the obstacle's edges boxes are placed, for a person beside a wider obstacle");
    field("max_lateral_m", self.max_lateral_m, Range{0.0, 10.0},
          "how far from the obstacle's middle boxes are placed at most");
    field("vertical_shifts", self.vertical_shifts, Range{0, 8},
          "boxes above, and as many below, the one that stands on the road: range and road are uncertain");
    field("step", self.step, Range{0.0, 1.0},
          "distance between boxes side by side and one above the other, in heights of the window; 0: that at which "
          "the classifier's first look shares its features between them");
    field("person_share", self.person_share, Range{0.3, 1.0},
          "height of the person over height of the window, as the classifier was trained");
    field("min_person_px", self.min_person_px, Range{8.0, 1000.0},
          "persons shorter than this in the image are not looked for");
    field("min_obstacle_height_m", self.min_obstacle_height_m, Range{0.0, 3.0},
          "an obstacle lower than this is no person; lenient, for measured heights are noisy");
    field("min_stretch_m", self.min_stretch_m, Range{0.0, 1000.0},
          "surfaces of the scan that no obstacle's boxes cover give boxes, too, when they are at least this wide; 1000 "
          "for none");
    field("merge_step", self.merge_step, Range{0.0, 0.5},
          "of two windows that agree to about this share of their height only the first is kept; 0 keeps all");
  }
};

/// Proposes where to look for people: around every obstacle that may be one, boxes of a few heights with the feet on
/// the road at the obstacle's range, side by side across its width, and a little above and below (Li 2010, IV).
/// Boxes of one obstacle and height follow each other and lie on a raster. The same at stretches of the scan's surfaces
/// that those boxes leave out: a person may stand before a plain wall, or be one obstacle with a car.
/// @param obstacles       in the vehicle frame; entries that are not finite or lie behind the camera give no box
/// @param scan            of the same pair; empty: boxes of the obstacles alone
/// @param projection      of the camera; boxes are in its left image
/// @param road            what the feet stand on
/// @param image_width_px  size of the left image; a person wholly outside it gives no box
/// @param image_height_px
/// @returns in the order of the obstacles, then of the stretches, of each by height; at most
/// `max_rois_per_obstacle(options)` for each
/// @throws InputError when an option is out of its range or `min_height_m` exceeds `max_height_m`
std::vector<Roi> propose_rois(std::span<const Obstacle> obstacles, const Scan& scan, const Projection& projection,
                              const RoadPlane& road, int image_width_px, int image_height_px,
                              const ProposeOptions& options);

/// @throws InputError naming `source` when an option is out of its range, or `min_height_m` exceeds `max_height_m`
void check_propose_options(const ProposeOptions& options, const std::string& source);

/// `options.step`, and where that is 0 a twelfth.
double step_between_boxes(const ProposeOptions& options);

/// The most boxes `propose_rois` makes for one obstacle.
std::size_t max_rois_per_obstacle(const ProposeOptions& options);

}  // namespace flies
