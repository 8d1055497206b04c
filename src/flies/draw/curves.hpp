#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// Plots of how good a classifier is. Each function returns a new image, CV_8UC3 in BGR order; values that are not
/// finite and empty inputs draw nothing.
namespace flies {

/// A point of a detection error trade-off (DET): what one threshold lets through, and what it loses.
struct ErrorPoint {
  double false_positives = 0.0;  ///< a window, or a picture
  double miss_rate = 0.0;        ///< 0..1
};

/// One classifier's points in order of falling threshold: false positives grow, the miss rate falls.
struct ErrorCurve {
  std::string title;
  std::vector<ErrorPoint> points;
  std::optional<ErrorPoint> operating_point;  ///< marked with a dot
};

/// The part of the plane that is shown; both axes are logarithmic, so all limits are above 0.
struct ErrorAxes {
  std::string false_positives_label = "false positives a window";
  std::string miss_rate_label = "miss rate";
  double min_false_positives = 1e-5, max_false_positives = 1e-1;
  double min_miss_rate = 0.01, max_miss_rate = 1.0;
};

/// DET curves over each other, as steps: between two points nothing better was seen than the first of them. A miss rate
/// below the axis, 0 above all, runs along its lower edge.
cv::Mat draw_error_curves(std::span<const ErrorCurve> curves, const ErrorAxes& axes = {});

/// What one classifier's probabilities are worth.
struct ReliabilityCurve {
  std::string title;
  std::vector<std::pair<double, double>> points;  ///< mean probability and share of people, 0..1; rising probability
};

/// Share of people over probability, both 0 to 1, beside the diagonal, which a calibrated classifier follows.
cv::Mat draw_reliability(std::span<const ReliabilityCurve> curves);

/// Scores of windows with and without a person.
struct ScorePlot {
  std::string title;
  std::vector<double> positives, negatives;
  std::optional<double> threshold;
};

/// Two histograms over the same axis, each scaled to its own sum so that few positives show beside many negatives; the
/// share axis is logarithmic, because the tails decide.
cv::Mat draw_score_histograms(const ScorePlot& plot);

}  // namespace flies
