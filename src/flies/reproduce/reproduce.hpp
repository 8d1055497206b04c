#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flies/core/results.hpp"
#include "flies/reproduce/labelled_frame.hpp"
#include "flies/reproduce/person_experiment.hpp"

/// The experiments of Li 2010, section V, on any labelled frames, beside the paper's numbers.
namespace flies {

/// Frames that are measured together: a column of the table.
struct FrameSet {
  std::string title;        ///< "KITTI drive 0005"
  std::string description;  ///< a sentence for the report
  std::vector<LabelledFrame> frames;
};

/// One measure of the table.
struct ExperimentRow {
  std::string_view key;    ///< of the JSON; ends in its unit
  std::string_view label;  ///< for people
  std::string_view unit;
  int decimals = 2;
  std::optional<double> paper;    ///< nothing where the paper gives none
  bool smaller_is_better = true;  ///< false: neither is
  /// Its value in one run. The table takes sizes of signed errors.
  std::optional<double> (*value)(const PersonPlace& person, const PersonRun& run) = nullptr;
};
/// In order of the table.
std::span<const ExperimentRow> experiment_rows();

/// A person of one frame, with all runs.
struct MeasuredPerson {
  std::size_t frame = 0;  ///< index into the set's frames
  PersonExperiment experiment;
};

/// Wall-clock times of the method on one frame, median of `runs` after one that is not counted.
struct Timing {
  std::string frame;
  int runs = 0;
  int threads = 1;
  StageTimes_ms median_ms{};
  std::size_t evaluations = 0;  ///< of the fitness
};

struct SetResult {
  std::vector<MeasuredPerson> people;  ///< never empty
  /// One per entry of `experiment_rows()`: for each seed the median over people, then the spread over the seeds.
  std::vector<std::optional<Spread>> rows;
  Timing timing;          ///< on the frame of the shown person
  std::size_t shown = 0;  ///< index of the person whose range is nearest to the paper's 15.52 m
};

/// The scenes that need no data: a person alone 15.5 m ahead as in the paper's figure 3, and a street.
/// @param scenes pairs of each, > 0; their seeds count up from 1
/// @param progress called after each pair with how many are done
std::vector<FrameSet> embedded_sets(int scenes, const std::function<void(std::size_t)>& progress = {});

/// Repeats the paper's experiments on every person of the set.
/// @param progress called after each person with how many are done
/// @throws InputError when no frame shows a person that counts, or an option is out of range
SetResult reproduce(const FrameSet& set, const PersonOptions& options,
                    const std::function<void(std::size_t)>& progress = {});

/// People of a set that will be measured.
std::size_t count_people(const FrameSet& set, const MatchOptions& match);

}  // namespace flies
