#pragma once

#include <vector>

#include "flies/eval/window_rates.hpp"

namespace flies {

/// Windows whose probabilities lie in one interval.
struct ReliabilityBin {
  double from = 0.0, to = 1.0;         ///< of the probability; the last bin includes 1
  std::size_t people = 0, others = 0;  ///< windows with and without a person
  double mean_probability = 0.0;       ///< weighted as below; 0 without windows
  double people_share = 0.0;           ///< the same; a calibrated classifier has both equal
};

/// Whether probabilities mean what they say.
struct Reliability {
  std::vector<ReliabilityBin> bins;  ///< ten equal ones from 0 to 1
  /// Expected calibration error (Naeini, Cooper, Hauskrecht 2015): mean distance of the two over the windows.
  double calibration_error = 0.0;
};

/// What a probability depends on beside the window is how many windows show a person: windows are weighted as if so
/// many did.
inline constexpr double kReliabilityPeople = 0.1;

/// @param scores log-odds, infinite ones included; at least one window with and one without a person
Reliability reliability(const WindowScores& scores);

}  // namespace flies
