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
  std::vector<double> reordered = values;
  EXPECT_EQ(lower_quantile(reordered, 0.4), 2);  // rank 1.6
  EXPECT_EQ(lower_quantile(reordered, 1.0), 5);
}

TEST(UpperMedian, IsTheUpperOfTwoMiddleValues) {
  EXPECT_EQ(upper_median(std::vector<double>{3, 1, 2}), 2);
  EXPECT_EQ(upper_median(std::vector<double>{4, 1, 3, 2}), 3);
}

TEST(Median, IsTheMeanOfTheTwoMiddleValuesOfAnEvenNumber) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
  EXPECT_EQ(median({7}), 7);
  EXPECT_EQ(median({}), std::nullopt);
}

}  // namespace
}  // namespace flies
