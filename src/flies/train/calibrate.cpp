#include "flies/train/calibrate.hpp"

#include <cmath>
#include <cstddef>

namespace flies {
namespace {

/// Scores of one kind and the probability that each of them should get.
struct Kind {
  std::span<const double> scores;
  double target = 0.0;
};

double cross_entropy(const ScoreCalibration& fit, std::span<const Kind> kinds) {
  double sum = 0.0;
  for (const auto& kind : kinds) {
    for (const double score : kind.scores) {
      const double z = fit.slope * score + fit.offset;
      // Both forms are log(1 + exp(z)) - target * z; the one that cannot overflow is taken.
      sum += z >= 0.0 ? (1.0 - kind.target) * z + std::log1p(std::exp(-z)) : -kind.target * z + std::log1p(std::exp(z));
    }
  }
  return sum;
}

}  // namespace

ScoreCalibration fit_calibration(std::span<const double> people, std::span<const double> background) {
  constexpr int kMaxIterations = 100;
  constexpr double kSmallestStep = 1e-10;
  constexpr double kFlatGradient = 1e-5;
  constexpr double kRidge = 1e-12;  // keeps the Hessian invertible
  if (people.empty() || background.empty()) return {};

  const auto n_people = static_cast<double>(people.size()), n_background = static_cast<double>(background.size());
  const Kind kinds[] = {{people, (n_people + 1.0) / (n_people + 2.0)}, {background, 1.0 / (n_background + 2.0)}};
  ScoreCalibration fit{0.0, std::log((n_people + 1.0) / (n_background + 1.0))};
  double value = cross_entropy(fit, kinds);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    double h11 = kRidge, h22 = kRidge, h21 = 0.0, g1 = 0.0, g2 = 0.0;
    for (const auto& kind : kinds) {
      for (const double score : kind.scores) {
        const double p = probability(fit, score), weight = p * (1.0 - p);
        h11 += score * score * weight;
        h22 += weight;
        h21 += score * weight;
        g1 += score * (p - kind.target);
        g2 += p - kind.target;
      }
    }
    if (std::abs(g1) < kFlatGradient && std::abs(g2) < kFlatGradient) break;
    const double determinant = h11 * h22 - h21 * h21;
    const double slope_step = -(h22 * g1 - h21 * g2) / determinant;
    const double offset_step = -(-h21 * g1 + h11 * g2) / determinant;
    const double decrease = g1 * slope_step + g2 * offset_step;
    double step = 1.0;
    for (; step >= kSmallestStep; step /= 2.0) {
      const ScoreCalibration next{fit.slope + step * slope_step, fit.offset + step * offset_step};
      const double next_value = cross_entropy(next, kinds);
      if (next_value < value + 1e-4 * step * decrease) {
        fit = next;
        value = next_value;
        break;
      }
    }
    if (step < kSmallestStep) break;
  }
  return fit.slope > 0.0 ? fit : ScoreCalibration{};
}

}  // namespace flies
