#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "flies/classify/people_classifier.hpp"
#include "flies/core/results.hpp"
#include "flies/eval/dataset.hpp"
#include "flies/eval/detections.hpp"
#include "flies/eval/estimate.hpp"
#include "flies/eval/hog_yardstick.hpp"
#include "flies/eval/network_yardstick.hpp"
#include "flies/eval/people.hpp"
#include "flies/eval/person_paths.hpp"
#include "flies/eval/scan_score.hpp"
#include "flies/eval/scan_truth.hpp"
#include "flies/eval/score.hpp"
#include "flies/eval/yardstick.hpp"
#include "flies/pipeline/detector.hpp"

namespace flies {

/// How it is measured.
struct EvaluationOptions {
  MatchOptions match = {};
  PeopleOptions people = {};
  EstimateOptions estimate = {};
  SectorOptions sectors = {};
};

/// The people that a method reports for one pair.
struct PeopleFindings {
  std::vector<Pedestrian> people;         ///< also those below the threshold, for the curve; all when that is not known
  std::optional<double> time_ms;          ///< from the pair to these verdicts
  std::optional<PeopleTrail> trail = {};  ///< where people were lost; nothing from a method that does not tell
};

/// The scan that a method reports for one pair.
struct ScanFindings {
  Scan scan;
  std::vector<std::pair<double, Scan>> by_setting = {};  ///< settings of `Method::scan_setting`, for the curve
};

/// What a method reports for one pair, and what it cost.
struct Findings {
  std::vector<Obstacle> obstacles;
  std::optional<double> time_ms;          ///< from the pair to its obstacles, without classification
  std::optional<double> evaluations;      ///< of the fitness
  std::optional<PeopleFindings> people;   ///< nothing from a method that does not look for people
  std::optional<ScanFindings> scan = {};  ///< nothing from a method that has none
};

/// Something that finds obstacles: several runs that differ in their seeds. A run sees the pairs in order.
/// @note a run is given the index of the pair in its dataset as well
using FindingRun = std::function<Findings(std::size_t, const TruthFrame&)>;
struct Method {
  std::string name;
  std::vector<FindingRun> runs;
  bool finds_obstacles = true;                                         ///< otherwise people only
  double people_threshold = -std::numeric_limits<double>::infinity();  ///< that reported people exceed
  std::string scan_setting = {};                                       ///< what the curve of its scan goes over
};

/// The detector with seeds `options.seed`, `options.seed` + 1, ... On a sequence, each pair steers the next one.
/// @param measuring says who is to be found, and when a box is his
Method flies_method(const std::string& name, const DetectorOptions& options, int seeds,
                    std::shared_ptr<const PeopleClassifier> classifier, bool is_sequence,
                    const EvaluationOptions& measuring = {});

/// OpenCV's search of the whole left image for people as a yardstick; without random numbers, so one run.
Method hog_method(HogDetector detector, const HogOptions& hog = {});

/// A network that searches the whole left image as a yardstick, called by its file's name; one run.
Method network_method(const std::string& weights_file, const NetworkSearchOptions& options = {});

/// Dense matching as a yardstick; without random numbers, so one run.
/// @param measuring says which of its points stand on the road
Method dense_method(DenseMatcher matcher, const DetectorOptions& options, const DenseOptions& dense = {},
                    const EvaluationOptions& measuring = {});

/// What other programs reported: a run a file, each in the order of the dataset's pairs.
Method reported_method(const std::string& name, std::vector<std::vector<ReportedFrame>> runs);

/// A counted object that some runs missed.
struct MissedInRuns {
  std::string frame_name;
  std::size_t index = 0;  ///< into the objects of that frame's truth
  LabelledObject object;
  int runs = 0;                                 ///< that missed it
  std::array<int, kPersonStageCount> stages{};  ///< of a person: how many runs lost him at each; none where untold
};

/// A report that no person stands behind.
struct FalseAlarm {
  std::string frame_name;
  Pedestrian person;
};

/// How one method did on people.
struct PeopleResult {
  std::map<MeasureKey, Estimate> estimates;  ///< names as of `people_values`
  std::vector<ErrorPoint> curve;             ///< all runs together
  ErrorPoint operating_point;
  std::optional<double> time_ms;         ///< median over pairs and runs, from the pair to its verdicts
  std::vector<MissedInRuns> missed;      ///< at the threshold, in order of frames
  std::vector<FalseAlarm> false_alarms;  ///< of the first run at the threshold, in order of frames
  std::optional<PeopleLosses> losses;    ///< by stage; nothing where it does not tell
};

/// How the scan came out at a setting, all pairs and runs together.
struct ScanPoint {
  double setting = 0.0;
  std::map<MeasureKey, double> values;  ///< names as of `scan_values`
};

/// How one method did on its scan.
struct ScanResult {
  std::map<MeasureKey, Estimate> estimates;  ///< names as of `scan_values`
  std::string setting;                       ///< what the curve goes over
  std::vector<ScanPoint> curve;
};

/// How one method did.
struct MethodResult {
  std::string name;
  int runs = 0;
  bool finds_obstacles = true;
  std::map<MeasureKey, Estimate> estimates;
  std::optional<double> time_ms;      ///< median over pairs and runs
  std::optional<double> evaluations;  ///< mean over pairs and runs
  std::vector<MissedInRuns> missed;   ///< in order of frames
  std::optional<PeopleResult> people;
  std::optional<ScanResult> scan;  ///< nothing where it has none, or where no pair has truth for one
};

/// How many labelled objects of a class or a band of range are to be found.
struct ObjectCount {
  std::string part;
  int objects = 0;
};

struct Evaluation {
  std::size_t frames = 0;
  std::size_t frames_with_lidar = 0;
  int objects = 0;                    ///< labelled ones that are to be found
  std::vector<ObjectCount> by_class;  ///< in alphabetical order
  std::vector<ObjectCount> by_range;  ///< from near to far
  int people = 0;                     ///< that are to be found
  std::vector<ObjectCount> people_by_range;
  ScanScore sectors;  ///< only its counts of sectors: near ones and open ones too
  std::vector<MethodResult> methods;
};

/// Lets every method find obstacles and people in the pairs of the dataset and measures them against its truth.
/// @param frames   indices of pairs, in order
/// @param progress called with the number of pairs done
/// @throws InputError from reading the pairs and from the methods, and naming images that are no pair
Evaluation evaluate(const Dataset& dataset, std::span<const std::size_t> frames, const std::vector<Method>& methods,
                    const EvaluationOptions& options = {}, const std::function<void(std::size_t)>& progress = {});

}  // namespace flies
