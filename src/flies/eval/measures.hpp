#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flies/eval/score.hpp"
#include "flies/eval/truth.hpp"

namespace flies {

/// Hits among so many.
struct Rate {
  int hits = 0;
  int total = 0;
  std::optional<double> value() const {
    return total == 0 ? std::nullopt : std::optional(static_cast<double>(hits) / total);
  }
};

/// Accuracy over some objects and obstacles. Medians are empty where nothing could be measured; those of errors are
/// over the obstacles that were reported for counted objects.
struct Accuracy {
  Rate recall;           ///< counted objects that were found
  Rate precision;        ///< obstacles that are right, in frames with lidar
  Rate label_precision;  ///< obstacles near any label, in frames without: labels leave things out, so a lower bound
  std::optional<double> range_error;           ///< signed, of the near face's range; positive when too far
  std::optional<double> absolute_range_error;  ///< of the near face's range
  std::optional<double> width_error_m;         ///< signed; positive when too wide
  std::optional<double> absolute_width_error_m;
  std::optional<double> depth_error_m;  ///< signed; positive when too deep; of the faces turned to us
  std::optional<double> absolute_depth_error_m;
  std::optional<double> height_error_m;  ///< signed; positive when too high
  std::optional<double> absolute_height_error_m;
};

/// Accuracy in a part of the whole.
struct AccuracyPart {
  std::string name;  ///< "Cyclist" or "10-20 m"
  Accuracy accuracy;
};

/// A labelled object that was not found.
struct MissedObject {
  int frame = 0;
  std::string frame_name;
  LabelledObject object;
};

/// Accuracy over many frames.
struct Measures {
  Accuracy all;
  std::optional<double> whole_width_error_m;  ///< absolute, of what `is_seen_whole`
  std::optional<double> whole_depth_error_m;  ///< the same of depth
  Rate people_recall;                         ///< people and cyclists, `kPeopleReach_m` at most
  std::vector<AccuracyPart> by_class;         ///< of objects, in alphabetical order; precision knows no classes
  std::vector<AccuracyPart> by_range;  ///< bands of `kRangeBands_m`: of the obstacle for precision, else of the object
  double obstacles_per_frame = 0.0;
  double reports_per_found_object = 0.0;  ///< 1 when nothing is reported twice
  std::vector<MissedObject> missed;
};

inline constexpr std::array<double, 5> kRangeBands_m = {5.0, 10.0, 20.0, 30.0, 40.0};
inline constexpr double kPeopleReach_m = 30.0;

/// True for the classes of people, on foot or on a cycle.
bool is_person(const LabelledObject& object);

/// True for cars, vans and people that lie wholly in view and are labelled as hidden by nothing, so that the whole
/// width is there to be seen.
bool is_seen_whole(const LabelledObject& object);

/// Sums the verdicts up. `truths` and `scores` go together, frame by frame.
Measures summarize(std::span<const FrameTruth> truths, std::span<const FrameScore> scores);

/// The same over some of the frames; one that is named twice counts twice.
Measures summarize(std::span<const FrameTruth> truths, std::span<const FrameScore> scores,
                   std::span<const std::size_t> frames);

}  // namespace flies
