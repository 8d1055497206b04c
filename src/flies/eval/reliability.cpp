#include "flies/eval/reliability.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace flies {
namespace {

constexpr std::size_t kBins = 10;

double probability_of(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

std::size_t bin_of(double probability) {
  return std::min(kBins - 1, static_cast<std::size_t>(probability * static_cast<double>(kBins)));
}

}  // namespace

Reliability reliability(const WindowScores& scores) {
  Reliability result;
  for (std::size_t i = 0; i < kBins; ++i)
    result.bins.push_back({static_cast<double>(i) / kBins, static_cast<double>(i + 1) / kBins, 0, 0, 0.0, 0.0});
  std::vector<double> people_sums(kBins, 0.0), other_sums(kBins, 0.0);  // of probabilities
  std::size_t people = 0, others = 0;
  const auto add = [&](const std::vector<double>& log_odds, std::size_t ReliabilityBin::*count,
                       std::vector<double>& sums) {
    for (const double value : log_odds) {
      const double probability = probability_of(value);
      ++(result.bins[bin_of(probability)].*count);
      sums[bin_of(probability)] += probability;
    }
    return log_odds.size();
  };
  for (const auto& set : scores.positives) people += add(set.scores, &ReliabilityBin::people, people_sums);
  for (const auto& picture : scores.negatives) others += add(picture, &ReliabilityBin::others, other_sums);
  assert(people > 0 && others > 0);
  const double person_weight = kReliabilityPeople / static_cast<double>(people);
  const double other_weight = (1.0 - kReliabilityPeople) / static_cast<double>(others);
  for (std::size_t i = 0; i < kBins; ++i) {
    ReliabilityBin& bin = result.bins[i];
    const double hits = person_weight * static_cast<double>(bin.people);
    const double weight = hits + other_weight * static_cast<double>(bin.others);
    if (!(weight > 0.0)) continue;
    bin.people_share = hits / weight;
    bin.mean_probability = (person_weight * people_sums[i] + other_weight * other_sums[i]) / weight;
    result.calibration_error += weight * std::abs(bin.mean_probability - bin.people_share);
  }
  return result;
}

}  // namespace flies
