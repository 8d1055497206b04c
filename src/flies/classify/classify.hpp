#pragma once

#include <span>
#include <vector>

#include "flies/classify/people_model.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/propose/propose.hpp"

namespace flies {

struct ClassifyOptions {
  double threshold_offset = 0.0;
  double lateral_radius_m = 0.4;
  double depth_radius = 0.15;
  double max_overlap = 0.6;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("threshold_offset", self.threshold_offset, Range{-100.0, 100.0},
          "added to the model's threshold: higher reports fewer people and fewer false alarms");
    field("lateral_radius_m", self.lateral_radius_m, Range{0.0, 5.0},
          "of two verdicts closer than this across the line of sight, and close in depth, the surer is kept");
    field("depth_radius", self.depth_radius, Range{0.0, 1.0},
          "of two verdicts closer in depth than this share of their range, and close sideways, the surer is kept");
    field("max_overlap", self.max_overlap, Range{0.0, 1.0},
          "of two verdicts, at whatever range, of which one covers more than this share of the other in the image, the "
          "surer is kept");
  }
};

/// Scores every window with the model: crop, resize to the model's window, features, dot product (METHOD section 5).
/// Where a window leaves the image, the border pixels are repeated.
/// @param left the left image, with pixels
/// @returns one score per ROI; `-infinity` for a window without area, not finite, or wholly outside the image
/// Threads: runs on oneTBB's current arena; results do not depend on the number of threads.
/// @throws InputError when the model is inconsistent
std::vector<double> score_rois(const GrayView& left, std::span<const Roi> rois, const PeopleModel& model);

/// One verdict per person: ROI above the threshold compete, the surest first, with those that stand at the same place
/// on the ground or cover the same part of the image.
/// @param scores one per ROI
/// @returns nearest first
std::vector<Pedestrian> suppress_in_metres(std::span<const Roi> rois, std::span<const double> scores,
                                           const PeopleModel& model, const ClassifyOptions& options);

}  // namespace flies
