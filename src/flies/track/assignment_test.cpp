#include "flies/track/assignment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "flies/core/random.hpp"

namespace flies {
namespace {

using testing::ElementsAre;

constexpr double kForbidden = std::numeric_limits<double>::infinity();

TEST(AssignOptimally, TakesTheLeastSumNotTheLeastPair) {
  // The cheapest pair (0, 0) would leave row 1 with 9.
  EXPECT_THAT(assign_optimally(std::vector<double>{1, 2, 2, 9}, 2, 2, std::vector<double>{20, 20}), ElementsAre(1, 0));
}

TEST(AssignOptimally, LeavesARowAloneWhereThatIsCheaper) {
  EXPECT_THAT(assign_optimally(std::vector<double>{1, 8}, 2, 1, std::vector<double>{5, 5}), ElementsAre(0, -1));
  EXPECT_THAT(assign_optimally(std::vector<double>{kForbidden, kForbidden}, 1, 2, std::vector<double>{5}),
              ElementsAre(-1));
  EXPECT_THAT(assign_optimally({}, 2, 0, std::vector<double>{5, 5}), ElementsAre(-1, -1));
  EXPECT_TRUE(assign_optimally({}, 0, 3, {}).empty());
}

TEST(AssignOptimally, TakesCostsThatAreNoNumbersForForbidden) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(assign_optimally(std::vector<double>{kNan, 2, -kForbidden, kNan}, 2, 2, std::vector<double>{5, 5}),
              ElementsAre(1, -1));
  EXPECT_THAT(assign_optimally(std::vector<double>{1, 2, 3, 4}, 2, 2, std::vector<double>{kNan, 9}),
              ElementsAre(-1, 0));
}

TEST(AssignOptimally, IsAsGoodAsTryingEverything) {
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    constexpr std::size_t kRows = 4, kColumns = 5;
    FlyRandom random(9, 0, trial, 0);
    std::vector<double> costs(kRows * kColumns), alone(kRows);
    for (auto& c : costs) c = random.uniform() < 0.2 ? kForbidden : random.uniform(-5, 10);
    for (auto& a : alone) a = random.uniform(0, 8);
    const auto price = [&](const std::vector<int>& columns) {
      double sum = 0.0;
      for (std::size_t i = 0; i < kRows; ++i)
        sum += columns[i] < 0 ? alone[i] : costs[i * kColumns + static_cast<std::size_t>(columns[i])];
      return sum;
    };
    double least = kForbidden;
    std::vector<int> choice(kRows);
    const auto try_all = [&](auto&& self, std::size_t row) -> void {
      if (row == kRows) {
        least = std::min(least, price(choice));
        return;
      }
      for (int column = -1; column < static_cast<int>(kColumns); ++column) {
        if (column >= 0 && std::count(choice.begin(), choice.begin() + static_cast<std::ptrdiff_t>(row), column) > 0)
          continue;
        choice[row] = column;
        self(self, row + 1);
      }
    };
    try_all(try_all, 0);
    EXPECT_NEAR(price(assign_optimally(costs, kRows, kColumns, alone)), least, 1e-9) << trial;
  }
}

}  // namespace
}  // namespace flies
