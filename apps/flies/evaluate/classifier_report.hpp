#pragma once

#include <span>
#include <string>
#include <vector>

#include "flies/eval/estimate.hpp"
#include "flies/eval/reliability.hpp"
#include "flies/eval/window_data.hpp"
#include "flies/eval/window_rates.hpp"

/// How one classifier did.
struct ClassifierResult {
  std::string model;  ///< as it was named
  flies::WindowScores scores;
  std::vector<flies::DetectionRate> rates;  ///< of all sets, then by set
  flies::Reliability reliability;
  double us_per_window = 0.0;  ///< wall-clock time in microseconds
};

/// What was looked at, beside the numbers.
struct ClassifierContext {
  std::string folder;
  std::string command;
  flies::WindowSampling sampling;
  flies::EstimateOptions estimate;
};

/// Detection rates for people to read: a column a model.
std::string classifier_table(std::span<const ClassifierResult> results, const ClassifierContext& context);

/// Everything as one JSON object, see docs/evaluation.md.
std::string classifier_json(std::span<const ClassifierResult> results, const ClassifierContext& context);

/// The table, DET and reliability curves, and the score histograms as one self-contained page.
std::string classifier_html(std::span<const ClassifierResult> results, const ClassifierContext& context);

/// The DET curves of all models, CV_8UC3.
cv::Mat classifier_curves(std::span<const ClassifierResult> results);
