#pragma once

#include <string>

#include "flies/train/train.hpp"

namespace flies {

/// What a reader needs to make the report's numbers again.
struct TrainingContext {
  std::string command;
  std::string version;
};

/// A page that is one file: numbers, DET curve, histograms of the probabilities, the hardest mistakes, the weights.
/// @throws InputError from reading a picture
std::string training_report_html(const TrainingData& data, const TrainOptions& options, const TrainingResult& result,
                                 const TrainingContext& context);

/// The numbers as lines of text.
std::string training_summary(const TrainOptions& options, const TrainingResult& result);

/// False positives a window at which the reports give detection rates.
inline constexpr double kReportedRates[] = {1e-4, 1e-3, 1e-2};

}  // namespace flies
