#include "flies/diagnose/row_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "flies/diagnose/textured_pair.hpp"

namespace flies {
namespace {

std::optional<RowError> row_error_of(const GrayPair& pair) {
  return fit_row_error(match_corners(pair.view()), pair.left.width_px);
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
  const auto error = fit_row_error(corners, 600);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->offset_px, 1.5, 0.05);
}

TEST(FitRowError, SaysNothingWhenMostDisagree) {
  std::vector<CornerMatch> corners;
  for (int i = 0; i < 300; ++i) corners.push_back({2.0 * i, 100.0, 2.0 * i, 100.0 + 40.0 * std::sin(1.7 * i)});
  EXPECT_FALSE(fit_row_error(corners, 600));
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
