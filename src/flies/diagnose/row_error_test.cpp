#include "flies/diagnose/row_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "flies/diagnose/textured_pair.hpp"

namespace flies {
namespace {

std::optional<RowError> row_error_of(const GrayPair& pair) {
  return fit_row_error(match_corners(pair.view()), pair.left.width_px, pair.left.height_px);
}

TEST(RowErrorOfAPair, IsFoundToATenthOfAPixel) {
  for (const double rows_px : {-3.0, -0.5, 0.0, 0.3, 1.0, 5.0}) {
    const auto error = row_error_of(textured_pair(8.0, rows_px, 0.0));
    ASSERT_TRUE(error) << rows_px;
    EXPECT_NEAR(error->offset_px, rows_px, 0.1) << rows_px;
    EXPECT_NEAR(error->slope * 640, 0.0, 0.2) << rows_px;
    EXPECT_GT(error->corners, 100) << rows_px;
  }
}

TEST(RowErrorOfAPair, TellsRollFromAnOffset) {
  const auto error = row_error_of(textured_pair(6.0, 0.5, 0.005));
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->offset_px, 0.5, 0.1);
  EXPECT_NEAR(error->slope, 0.005, 0.0005);
  EXPECT_NEAR(error->largest_px(), 0.5 + 0.005 * 319.5, 0.2);
  EXPECT_NEAR(error->typical_px(), std::hypot(0.5, 0.005 * 640 / std::sqrt(12.0)), 0.1);
}

TEST(RowErrorOfAPair, TellsAnImageThatIsLargerFromAnOffset) {
  for (const double growth : {-0.02, -0.01, 0.01, 0.02, 0.05}) {
    const auto error = row_error_of(textured_pair(6.0, 0.5, 0.002, growth));
    ASSERT_TRUE(error) << growth;
    EXPECT_NEAR(error->growth, growth, 0.1 * std::abs(growth)) << growth;
    EXPECT_NEAR(error->offset_px, 0.5, 0.1) << growth;
    EXPECT_NEAR(error->slope, 0.002, 0.0005) << growth;
  }
  EXPECT_EQ(row_error_of(textured_pair(6.0, 0.5, 0.002, 0.003))->growth, 0.0);  // as good pairs have it
}

TEST(RowErrorOfAPair, IsTheSameWhateverTheExposure) {
  for (const double gain : {0.25, 0.5, 0.7, 1.5, 2.0}) {
    GrayPair pair = textured_pair(6.0, 3.0, 0.0);
    for (auto& level : pair.right.pixels) level = static_cast<std::uint8_t>(std::min(255.0, gain * level));
    const auto error = row_error_of(pair);
    ASSERT_TRUE(error) << gain;
    EXPECT_NEAR(error->offset_px, 3.0, 0.1) << gain;
  }
}

TEST(RowErrorOfAPair, IsNotToldWithoutCorners) {
  GrayPair blank{{64, 48, std::vector<std::uint8_t>(64 * 48, 99)}, {64, 48, std::vector<std::uint8_t>(64 * 48, 99)}};
  EXPECT_FALSE(row_error_of(blank));
}

TEST(FitRowError, IsNotMisledByAThirdOfWrongMatches) {
  std::vector<CornerMatch> corners;
  for (int i = 0; i < 300; ++i) {
    const double u = 2.0 * i, wrong = i % 3 == 0 ? -9.0 + 0.1 * (i % 50) : 0.0;
    corners.push_back({u, 100.0, u - 5.0, 100.0 + 1.5 + wrong});
  }
  const auto error = fit_row_error(corners, 600, 240);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->offset_px, 1.5, 0.05);
}

TEST(FitRowError, SaysNothingWhenMostDisagree) {
  std::vector<CornerMatch> corners;
  for (int i = 0; i < 300; ++i) corners.push_back({2.0 * i, 100.0, 2.0 * i, 100.0 + 40.0 * std::sin(1.7 * i)});
  EXPECT_FALSE(fit_row_error(corners, 600, 240));
}

TEST(FitRowError, OfCornersInOneRowKnowsNoGrowth) {
  std::vector<CornerMatch> corners;
  for (int i = 0; i < 100; ++i) corners.push_back({6.0 * i, 20.0 + i % 2, 6.0 * i - 5.0, 21.0 + i % 2});
  const auto error = fit_row_error(corners, 600, 240);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->growth, 0.0);
  EXPECT_NEAR(error->offset_px, 1.0, 0.01);
}

TEST(RowErrors, DifferByOffsetRollAndGrowth) {
  const RowError none{.middle_u_px = 300.0, .middle_v_px = 100.0};
  RowError other = none;
  other.offset_px = 2.0;
  EXPECT_NEAR(other.differs_px(none), 2.0, 1e-9);
  other.offset_px = 0.0, other.slope = 0.01;
  EXPECT_NEAR(other.differs_px(none), 6.0 / std::sqrt(12.0), 1e-9);
  other.slope = 0.0, other.growth = 0.02;
  EXPECT_NEAR(other.differs_px(none), 4.0 / std::sqrt(12.0), 1e-9);
}

TEST(CorrectRows, UndoesTheError) {
  GrayPair pair = textured_pair(6.0, 2.0, 0.004);
  const auto before = row_error_of(pair);
  ASSERT_TRUE(before);
  correct_rows(*before, pair);
  const auto after = row_error_of(pair);
  ASSERT_TRUE(after);
  EXPECT_LT(after->largest_px(), 0.15);
}

TEST(MedianRowError, IsNotMovedByOneBadPair) {
  RowError good, bad;
  good.offset_px = 0.2;
  bad.offset_px = 9.0;
  const auto median = median_row_error(std::vector{good, bad, good});
  ASSERT_TRUE(median);
  EXPECT_EQ(median->offset_px, 0.2);
  EXPECT_FALSE(median_row_error({}));
}

}  // namespace
}  // namespace flies
