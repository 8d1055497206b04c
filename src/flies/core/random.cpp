#include "flies/core/random.hpp"

#include <cstddef>

namespace flies {
namespace {

constexpr int kIndexBits = 9;
constexpr std::size_t kIntervals = std::size_t{1} << kIndexBits;

/// Knots of the quantile function of |z|: a standard normal deviate is below knot k with probability k / kIntervals.
std::array<float, kIntervals + 1> make_knots() {
  std::array<double, kIntervals> z{};
  for (std::size_t k = 1; k < kIntervals; ++k) {
    const double probability = static_cast<double>(k) / kIntervals;
    z[k] = z[k - 1];
    // Newton's method from below converges monotonically, as the distribution function of |z| is concave.
    for (int step = 0; step < 50; ++step)
      z[k] += (probability - std::erf(z[k] / std::numbers::sqrt2)) * std::sqrt(0.5 * std::numbers::pi) *
              std::exp(0.5 * z[k] * z[k]);
  }
  // The true last knot is infinite. Ours makes the variance 1: the square of a number uniform between a and b has the
  // mean (a^2 + a b + b^2) / 3.
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < kIntervals; ++k) sum += (z[k] * z[k] + z[k] * z[k + 1] + z[k + 1] * z[k + 1]) / 3.0;
  const double a = z.back(), mean_square = kIntervals - sum;
  std::array<float, kIntervals + 1> knots{};
  for (std::size_t k = 0; k < kIntervals; ++k) knots[k] = static_cast<float>(z[k]);
  knots[kIntervals] = static_cast<float>(0.5 * (std::sqrt(12.0 * mean_square - 3.0 * a * a) - a));
  return knots;
}

}  // namespace

double standard_normal(std::uint32_t word) {
  static const auto knots = make_knots();
  constexpr int kFractionBits = 32 - kIndexBits - 1;
  const std::size_t k = word >> (32 - kIndexBits);
  const double fraction = ((word >> 1) & ((1u << kFractionBits) - 1)) * (1.0 / (1u << kFractionBits));
  const double magnitude = knots[k] + fraction * (knots[k + 1] - knots[k]);
  constexpr double kSigns[] = {1.0, -1.0};  // no branch, which would be mispredicted every other time
  return kSigns[word & 1u] * magnitude;
}

}  // namespace flies
