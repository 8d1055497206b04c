#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flies/draw/curves.hpp"
#include "flies/eval/estimate.hpp"

namespace flies {

/// Scores that a classifier gave to windows with a person, by the set they come from.
struct PositiveScores {
  std::string set;
  std::vector<double> scores;
};

/// What a classifier made of all windows; larger scores are surer.
struct WindowScores {
  std::vector<PositiveScores> positives;
  std::vector<std::vector<double>> negatives;  ///< windows without a person, a list a picture
};

/// Share of the people found where so many false positives are let through.
struct DetectionRate {
  std::string set;                          ///< empty for all sets together
  double false_positives_per_window = 0.0;  ///< asked for
  double threshold = 0.0;                   ///< a window is a person when its score exceeds this
  double rate = 0.0;                        ///< 0..1
  std::optional<double> low, high;          ///< interval; none without resamples
  bool is_measured = true;                  ///< else there are too few windows without people to tell
};

/// Whether so many windows without people can tell a rate of false positives: one of them at least may be one.
bool can_tell(std::size_t windows, double false_positives_per_window);

/// The lowest score that at most this share of the negatives exceeds.
/// @param negatives                  at least one
/// @param false_positives_per_window 0..1
/// @returns `-infinity` when all of them may count as people
double threshold_at(std::span<const double> negatives, double false_positives_per_window);

/// Detection rates over all sets and then by set, for each wanted rate of false positives. Intervals by the bootstrap
/// (Efron 1979, percentile method): windows with people are drawn with replacement, and so are the pictures that the
/// other windows come from, for windows of one picture resemble each other.
/// @param scores at least one positive and one negative
std::vector<DetectionRate> detection_rates(const WindowScores& scores,
                                           std::span<const double> false_positives_per_window,
                                           const EstimateOptions& options = {});

/// The detection error trade-off of all sets together, in order of falling threshold: a point wherever a person more
/// is found.
std::vector<ErrorPoint> error_points(const WindowScores& scores);

}  // namespace flies
