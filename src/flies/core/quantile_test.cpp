#include "flies/core/quantile.hpp"

#include <gtest/gtest.h>

namespace flies {
namespace {

TEST(Quantile, IsTheValueOfTheNearestRank) {
  const std::vector<double> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(quantile(values, 0.0), 1);
  EXPECT_EQ(quantile(values, 1.0), 5);
  EXPECT_EQ(quantile(values, 0.3), 2);  // rank 1.2
  EXPECT_EQ(quantile(values, 0.4), 3);  // rank 1.6
  EXPECT_EQ(quantile(std::vector<float>{7.5F}, 0.9), 7.5F);
}

TEST(MedianOf, IsTheUpperOfTwoMiddleValues) {
  EXPECT_EQ(median_of(std::vector<double>{3, 1, 2}), 2);
  EXPECT_EQ(median_of(std::vector<double>{4, 1, 3, 2}), 3);
}

}  // namespace
}  // namespace flies
