#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/results.hpp"
#include "flies/eval/measures.hpp"
#include "flies/eval/score.hpp"
#include "flies/eval/truth.hpp"
#include "flies/io/test_data.hpp"
#include "flies/pipeline/detector.hpp"

/// What the tests on real pairs share: where the data is, running the detector, the score table.
namespace flies::blackbox {

using testing::absence;
using testing::find_data;

/// What was reported for one frame, and its verdicts.
struct ScoredFrame {
  FrameTruth truth;
  Detection detection;
  FrameScore score;
};

/// Runs the detector on one pair of image files and scores its obstacles.
ScoredFrame detect_and_score(Detector& detector, const std::filesystem::path& left, const std::filesystem::path& right,
                             FrameTruth truth, const MatchOptions& options = {});

/// Reported people against labelled ones, over the frames: how many have to be found and are, and how many are none.
struct PeopleCount {
  int wanted = 0, found = 0, false_alarms = 0;
};
PeopleCount count_people(const std::vector<ScoredFrame>& frames);

/// What became of one labelled object over the frames.
struct ObjectRow {
  std::string name;  ///< "Cyclist 1"
  int in_view = 0;   ///< frames in which it had to be found
  int found = 0;
  std::vector<std::string> missed_in;  ///< names of the frames in which it was not
  std::vector<double> range_errors;    ///< of obstacles reported for it, relative
};

/// One row per type and track that was counted in any frame, in order of name.
std::vector<ObjectRow> tabulate(const std::vector<ScoredFrame>& frames);

/// Prints the rows under a title.
void print_table(const std::string& title, const std::vector<ObjectRow>& rows);

/// Prints precision, recall, range error and obstacles per frame on one line. @returns all measures
Measures print_summary(const std::vector<ScoredFrame>& frames);

}  // namespace flies::blackbox
