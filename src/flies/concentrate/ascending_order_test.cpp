#include "flies/concentrate/ascending_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <vector>

#include "flies/core/random.hpp"

namespace flies {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::IsEmpty;

TEST(AscendingOrder, PutsEqualValuesInTheOrderOfTheirIndices) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_THAT(AscendingOrder().find(std::vector{2.0F, -1.0F, 0.0F, 2.0F, -kInfinity, -0.0F, -3.5F, kInfinity}),
              ElementsAre(4, 6, 1, 2, 5, 0, 3, 7));
}

TEST(AscendingOrder, SortsEveryNumberOfValues) {
  AscendingOrder order;
  for (const std::size_t count : {0U, 1U, 2U, 1000U, 300U}) {
    std::vector<float> values(count);
    for (std::size_t i = 0; i < count; ++i)
      values[i] = static_cast<float>(FlyRandom(1, 2, 3, static_cast<std::uint32_t>(i)).normal());
    std::vector<std::uint32_t> expected(count);
    std::iota(expected.begin(), expected.end(), 0U);
    std::sort(expected.begin(), expected.end(),
              [&](auto a, auto b) { return std::tie(values[a], a) < std::tie(values[b], b); });
    EXPECT_THAT(order.find(values), ElementsAreArray(expected));
  }
  EXPECT_THAT(order.find({}), IsEmpty());
}

}  // namespace
}  // namespace flies
