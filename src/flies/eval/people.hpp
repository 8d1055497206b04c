#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/draw/curves.hpp"
#include "flies/eval/estimate.hpp"
#include "flies/eval/truth.hpp"

namespace flies {

/// When a reported person and a labelled one agree, and which labelled ones have to be found.
struct PeopleOptions {
  double max_range_m = 25.0;
  double min_height_px = 40.0;
  double min_overlap = 0.5;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("max_range_m", self.max_range_m, Range{0, 1000}, "people farther away than this are ignored");
    field("min_height_px", self.min_height_px, Range{0, 10000}, "people shorter than this in the image are ignored");
    field("min_overlap", self.min_overlap, Range{0.01, 1.0}, "intersection over union of boxes that agree");
  }
};

/// What a labelled object is to a detector of pedestrians.
enum class PersonRole {
  other,    ///< no person: a report there is a false alarm
  counted,  ///< must be found
  ignored,  ///< neither hit nor false alarm: cyclists, sitting, heavily occluded, cut off, far or small people
};
PersonRole person_role(const LabelledObject& object, const PeopleOptions& options);

/// Intersection over union of two boxes in the image, 0..1.
double intersection_over_union(const ImageBox& a, const ImageBox& b);

/// The same of two boxes of people, each with a width of 0.41 of its height about its middle (see `score_people`).
double people_overlap(const ImageBox& a, const ImageBox& b);

/// What the truth says about one reported person.
struct PersonVerdict {
  enum class Kind { hit, false_alarm, ignored };
  Kind kind = Kind::false_alarm;
  Pedestrian person;
  int object = -1;                ///< index of the labelled person of a hit
  double near_range_m = 0.0;      ///< of that person's near face, where the lidar or the label has it
  double range_error_m = 0.0;     ///< reported minus `near_range_m`
  double position_error_m = 0.0;  ///< horizontal distance to the middle of that near face
};

/// Verdicts of one pair, the surest first, and the ranges of the people to be found.
struct PeopleFrame {
  std::vector<PersonVerdict> verdicts;
  std::vector<PersonRole> roles;  ///< of the truth's objects, in their order
  std::vector<double> ranges_m;   ///< of their labelled near faces
};

/// Holds reported against labelled people in the image, as is customary (Dollar et al., "Pedestrian detection: an
/// evaluation of the state of the art", 2012): the surest report takes the free counted person that it overlaps
/// most, if by `min_overlap`; a second report of the same person is a false alarm; a report that lies by half in an
/// ignored person or region is ignored. All boxes count with a width of 0.41 of their height about their middle, so
/// that arms and strides do not matter.
PeopleFrame score_people(const FrameTruth& truth, std::span<const Pedestrian> reports,
                         const PeopleOptions& options = {});

/// Mean, over the logarithm, of the miss rates at nine false-alarm rates spaced evenly in logarithm from 0.01 to 1
/// (Dollar et al. 2012). Where a curve has no point so far left, everything is missed.
/// @param points by rising false alarms
/// @param people number behind the miss rates, at least 1: a miss rate of 0 counts as half a person missed, for its
///               logarithm would decide alone
double log_average_miss_rate(std::span<const ErrorPoint> points, int people);

/// The pairs of one run of a method.
using PeopleRun = std::vector<PeopleFrame>;

/// Miss rate over false alarms a pair, all of the runs' pairs together; a point wherever a person more is found.
std::vector<ErrorPoint> people_curve(std::span<const PeopleRun> runs);

/// The point of that curve where only reports that exceed the threshold are made. The miss rate of nobody is NaN.
ErrorPoint people_operating_point(std::span<const PeopleRun> runs, double threshold);

/// Every measure of a run that has a value over some of its pairs; one that is named twice counts twice. Names:
/// `miss_rate` and `false_alarms_per_frame` at the threshold; `log_average_miss_rate`; over the hits at the threshold
/// `range_error` (signed), `absolute_range_error` and its 95 % quantile `absolute_range_error_95`, parts of the near
/// face's range, and `position_error_m`; medians but for the quantile. Of all and of each band of range; false alarms
/// belong to the band where they are reported.
std::map<MeasureKey, double> people_values(const PeopleRun& run, std::span<const std::size_t> frames, double threshold,
                                           const PeopleOptions& options = {});

/// The bands of range: their names and how many people each has to be found.
std::vector<std::pair<std::string, int>> people_by_range(const PeopleRun& run, const PeopleOptions& options = {});

}  // namespace flies
