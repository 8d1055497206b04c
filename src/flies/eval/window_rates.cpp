#include "flies/eval/window_rates.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "flies/core/quantile.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

constexpr double kRounding = 1e-9;  // 1e-3 of 3000 windows are 3, not 2.9999...

/// A negative's score and the picture it comes from.
struct Negative {
  double score;
  std::size_t picture;
};

/// All negatives, the surest first.
std::vector<Negative> ranked(const std::vector<std::vector<double>>& pictures) {
  std::vector<Negative> all;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    for (const double score : pictures[i]) all.push_back({score, i});
  std::stable_sort(all.begin(), all.end(), [](const Negative& a, const Negative& b) { return a.score > b.score; });
  return all;
}

/// `threshold_at` where every picture counts `weights[picture]` times.
double threshold_of(std::span<const Negative> ranked, const std::vector<std::vector<double>>& pictures,
                    std::span<const int> weights, double false_positives_per_window) {
  double total = 0.0;
  for (std::size_t i = 0; i < pictures.size(); ++i) total += weights[i] * static_cast<double>(pictures[i].size());
  const double allowed = false_positives_per_window * total + kRounding;
  double above = 0.0;
  for (const auto& negative : ranked) {
    above += weights[negative.picture];
    if (above > allowed) return negative.score;
  }
  return -std::numeric_limits<double>::infinity();
}

/// Positives of all sets in a row, with the set of each.
struct Positive {
  double score;
  std::size_t set;
};

std::vector<Positive> flattened(const std::vector<PositiveScores>& sets) {
  std::vector<Positive> all;
  for (std::size_t i = 0; i < sets.size(); ++i)
    for (const double score : sets[i].scores) all.push_back({score, i});
  return all;
}

/// Found and all, of every set; the last entry is all sets together.
std::vector<Rate> rates_above(double threshold, std::span<const Positive> positives, std::size_t sets) {
  std::vector<Rate> rates(sets + 1);
  for (const auto& positive : positives)
    for (const std::size_t i : {positive.set, sets}) {
      rates[i].hits += positive.score > threshold;
      ++rates[i].total;
    }
  return rates;
}

/// Values of the resamples by [wanted rate][set].
using Resampled = std::vector<std::vector<std::vector<double>>>;

Resampled resample(const WindowScores& scores, std::span<const Negative> negatives, std::span<const Positive> positives,
                   std::span<const double> wanted, const EstimateOptions& options) {
  const std::size_t sets = scores.positives.size(), pictures = scores.negatives.size();
  Resampled values(wanted.size(), std::vector<std::vector<double>>(sets + 1));
  for (int k = 0; k < options.resamples; ++k) {
    FlyRandom of_pictures(options.seed, 0, static_cast<std::uint32_t>(k), 0);
    FlyRandom of_people(options.seed, 1, static_cast<std::uint32_t>(k), 0);
    std::vector<int> weights(pictures, 0);
    for (std::size_t i = 0; i < pictures; ++i) ++weights[of_pictures.below(static_cast<std::uint32_t>(pictures))];
    std::vector<Positive> drawn;
    for (std::size_t i = 0; i < positives.size(); ++i)
      drawn.push_back(positives[of_people.below(static_cast<std::uint32_t>(positives.size()))]);
    for (std::size_t w = 0; w < wanted.size(); ++w) {
      const auto rates = rates_above(threshold_of(negatives, scores.negatives, weights, wanted[w]), drawn, sets);
      for (std::size_t set = 0; set <= sets; ++set)
        if (const auto rate = rates[set].value()) values[w][set].push_back(*rate);
    }
  }
  return values;
}

}  // namespace

bool can_tell(std::size_t windows, double false_positives_per_window) {
  return false_positives_per_window * static_cast<double>(windows) + kRounding >= 1.0;
}

double threshold_at(std::span<const double> negatives, double false_positives_per_window) {
  assert(!negatives.empty());
  const std::vector<std::vector<double>> one_picture = {{negatives.begin(), negatives.end()}};
  const int once = 1;
  return threshold_of(ranked(one_picture), one_picture, {&once, 1}, false_positives_per_window);
}

std::vector<DetectionRate> detection_rates(const WindowScores& scores, std::span<const double> wanted,
                                           const EstimateOptions& options) {
  const auto negatives = ranked(scores.negatives);
  const auto positives = flattened(scores.positives);
  assert(!negatives.empty() && !positives.empty());
  const std::size_t sets = scores.positives.size();
  const std::vector<int> once(scores.negatives.size(), 1);
  auto resampled = resample(scores, negatives, positives, wanted, options);

  std::vector<DetectionRate> rates;
  const auto add = [&](std::size_t set) {
    for (std::size_t w = 0; w < wanted.size(); ++w) {
      const double threshold = threshold_of(negatives, scores.negatives, once, wanted[w]);
      const auto rate = rates_above(threshold, positives, sets)[set].value();
      if (!rate) continue;
      DetectionRate entry{set < sets ? scores.positives[set].set : "", wanted[w], threshold, *rate, {}, {},
                          can_tell(negatives.size(), wanted[w])};
      if (auto& values = resampled[w][set]; !values.empty()) {
        entry.low = quantile(values, (1.0 - options.confidence) / 2.0);
        entry.high = quantile(values, (1.0 + options.confidence) / 2.0);
      }
      rates.push_back(entry);
    }
  };
  add(sets);
  for (std::size_t set = 0; set < sets; ++set) add(set);
  return rates;
}

std::vector<ErrorPoint> error_points(const WindowScores& scores) {
  const auto negatives = ranked(scores.negatives);
  auto positives = flattened(scores.positives);
  assert(!negatives.empty() && !positives.empty());
  std::sort(positives.begin(), positives.end(), [](const Positive& a, const Positive& b) { return a.score > b.score; });
  std::vector<ErrorPoint> points;
  std::size_t above = 0;
  for (std::size_t found = 1; found <= positives.size(); ++found) {
    const double score = positives[found - 1].score;
    // To find this person, everything that scores as high is let through.
    while (above < negatives.size() && negatives[above].score >= score) ++above;
    points.push_back({static_cast<double>(above) / static_cast<double>(negatives.size()),
                      1.0 - static_cast<double>(found) / static_cast<double>(positives.size())});
  }
  return points;
}

}  // namespace flies
