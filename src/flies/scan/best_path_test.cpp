#include "flies/scan/best_path.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "flies/core/random.hpp"

namespace flies {
namespace {

constexpr int kColumns = 5, kLabels = 5;  // the last label is no obstacle

double step_cost(int a, int b, const EvidenceOptions& options) {
  if (a == b) return 0.0;
  if (a == kLabels - 1 || b == kLabels - 1) return options.end;
  return std::min(options.jump, options.slant * std::abs(a - b));
}

double path_cost(const std::vector<float>& costs, const std::vector<int>& labels, const EvidenceOptions& options) {
  double sum = 0.0;
  for (int column = 0; column < kColumns; ++column) {
    sum += static_cast<double>(
        costs[static_cast<std::size_t>(column * kLabels + labels[static_cast<std::size_t>(column)])]);
    if (column > 0)
      sum += step_cost(labels[static_cast<std::size_t>(column - 1)], labels[static_cast<std::size_t>(column)], options);
  }
  return sum;
}

TEST(FindBestPath, IsAsCheapAsTheCheapestOfAllPaths) {
  constexpr double kRounding = 1e-4;
  for (std::uint32_t trial = 0; trial < 30; ++trial) {
    FlyRandom random(3, trial, 0, 0);
    const EvidenceOptions options{
        .slant = random.uniform(0, 1), .jump = random.uniform(0, 3), .end = random.uniform(0, 3)};
    std::vector<float> costs;
    for (int i = 0; i < kColumns * kLabels; ++i) costs.push_back(static_cast<float>(random.uniform(-2, 2)));
    double cheapest = std::numeric_limits<double>::infinity();
    std::vector<int> labels(kColumns, 0);
    for (int code = 0; code < 5 * 5 * 5 * 5 * 5; ++code) {
      int rest = code;
      for (auto& label : labels) {
        label = rest % kLabels;
        rest /= kLabels;
      }
      cheapest = std::min(cheapest, path_cost(costs, labels, options));
    }
    PathMemory memory;
    const auto& found = find_best_path({costs, kColumns, kLabels}, options, memory);
    EXPECT_NEAR(path_cost(costs, found, options), cheapest, kRounding) << "trial " << trial;
  }
}

TEST(FindBestPath, OfNoColumnsIsEmpty) {
  PathMemory memory;
  EXPECT_TRUE(find_best_path({{}, 0, 3}, {}, memory).empty());
}

}  // namespace
}  // namespace flies
