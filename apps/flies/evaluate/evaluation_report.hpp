#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flies/eval/evaluation.hpp"
#include "flies/eval/sequence.hpp"

/// What was evaluated and how, beside the numbers.
struct EvaluationContext {
  std::string folder;
  flies::TruthKind kind = flies::TruthKind::scenes;
  flies::EvaluationOptions measuring;
  flies::DenseOptions dense;
  flies::HogOptions hog;
  flies::TrackerOptions tracker;
  std::string preset;
  std::vector<std::string> notes;  ///< on calibration and images
  flies::DetectorOptions options;  ///< of the method's first run
};

/// The measures for people to read: a column a method.
std::string evaluation_table(const flies::Evaluation& evaluation, const EvaluationContext& context);

/// What following the pairs as one sequence gave.
std::string sequence_table(const flies::SequenceResult& sequence, const EvaluationContext& context);

/// The missed objects, the missed people and the false alarms, a line each.
std::string missed_table(const flies::Evaluation& evaluation);

/// Miss rates of people over false alarms a pair, CV_8UC3.
cv::Mat people_curves(const flies::Evaluation& evaluation);

/// Blind over ghost sectors of every method's scan at its settings, CV_8UC3.
cv::Mat scan_curves(const flies::Evaluation& evaluation);

/// Everything as one JSON object, see docs/evaluation.md.
std::string evaluation_json(const flies::Evaluation& evaluation, const EvaluationContext& context,
                            const std::optional<flies::SequenceResult>& sequence = std::nullopt);
