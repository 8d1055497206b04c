#pragma once

#include <memory>
#include <span>
#include <vector>

#include "flies/classify/people_classifier.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/propose/propose.hpp"

namespace flies {

struct ClassifyOptions {
  double threshold_offset = 0.6;
  double one_stage_threshold_offset = 2.0;
  double lateral_radius_m = 0.4;
  double depth_radius = 0.15;
  double max_overlap = 0.6;
  double min_first_probability = 0.002;
  double min_middle_probability = 0.002;
  double min_second_probability = 0.1;
  double min_refined_probability = 0.3;
  int second_looks = 5;
  int votes = 3;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("threshold_offset", self.threshold_offset, Range{-100.0, 100.0},
          "added to the threshold of a model of two stages, in log-odds: higher reports fewer people and fewer false "
          "alarms; boxes of flies stand on textured things, which look more like people than the windows that "
          "thresholds come from");
    field("one_stage_threshold_offset", self.one_stage_threshold_offset, Range{-100.0, 100.0},
          "the same for a model of one stage, whose verdicts are single boxes");
    field("lateral_radius_m", self.lateral_radius_m, Range{0.0, 5.0},
          "of two verdicts closer than this across the line of sight, and close in depth, the surer is kept");
    field("depth_radius", self.depth_radius, Range{0.0, 1.0},
          "of two verdicts closer in depth than this share of their range, and close sideways, the surer is kept");
    field("max_overlap", self.max_overlap, Range{0.0, 1.0},
          "of two verdicts, at whatever range, of which one covers more than this share of the other in the image, the "
          "surer is kept");
    field("min_first_probability", self.min_first_probability, Range{0.0, 1.0},
          "boxes less probable than this at first look are not shown to a model's second stage");
    field(
        "min_middle_probability", self.min_middle_probability, Range{0.0, 1.0},
        "an obstacle whose boxes of the middle height are all less probable than this at the first of two looks is no "
        "person, and its other heights are not looked at; 0 looks at all");
    field("min_second_probability", self.min_second_probability, Range{0.0, 1.0},
          "a place whose surest box is less probable than this by a model's second stage is no person, and no more of "
          "its boxes are looked at; 0 looks at all");
    field("min_refined_probability", self.min_refined_probability, Range{0.0, 1.0},
          "a place one of whose boxes is more probable than this by a model's second stage is looked at again in boxes "
          "half a step beside that one, a little larger and smaller; 1 refines none");
    field("second_looks", self.second_looks, Range{1, 1000},
          "boxes at each place that are shown to a model's second stage, the surest at first look");
    field("votes", self.votes, Range{1, 1000},
          "a place is a person when the mean log-odds of its so many surest boxes, by the second stage, say so; a "
          "box that the first look did not let through counts with the least log-odds that look lets through");
  }
};

struct ClassifyResult {
  std::vector<double> screened;         ///< the classifier's first look: one probability per ROI, 0 without a look
  std::vector<Pedestrian> pedestrians;  ///< nearest first
};

/// The options with boxes as far apart as the classifier shares what it computes between them, where `step` is 0.
ProposeOptions for_classifier(ProposeOptions options, const PeopleClassifier& classifier);

/// Finds the people among the boxes (Li 2010, IV): a cheap look at those of the middle height, and at the others
/// of the obstacles that may be people; the surest box at each place on the ground; the classifier's last word on
/// those.
/// @param left the image that the boxes belong to, with pixels
/// @throws InputError naming an option out of its range, or a classifier that does not answer with one probability a
///         window
/// Threads: runs on oneTBB's current arena; results do not depend on the number of threads.
ClassifyResult find_people(const GrayView& left, std::span<const Roi> rois, const PeopleClassifier& classifier,
                           const ClassifyOptions& options);

/// The probability above which a window is reported: the classifier's threshold with the offset of `options` for such
/// a model.
double report_threshold(const PeopleClassifier& classifier, const ClassifyOptions& options);

/// The probability that a box exceeds at first look to be looked at again; of a classifier of one stage that above.
double first_look_threshold(const PeopleClassifier& classifier, const ClassifyOptions& options);

/// One verdict per person: ROI above the threshold compete, the surest first, with those that stand at the same place
/// on the ground or cover the same part of the image.
/// @param probabilities one per ROI
/// @returns indices of the ROI that are kept, the surest first
std::vector<std::size_t> suppress_in_metres(std::span<const Roi> rois, std::span<const double> probabilities,
                                            double threshold, const ClassifyOptions& options);

}  // namespace flies
