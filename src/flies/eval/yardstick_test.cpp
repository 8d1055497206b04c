#include "flies/eval/yardstick.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"
#include "flies/io/gray_image.hpp"

namespace flies {
namespace {

constexpr double kBoard_m = 12.5;     // depth of the board: 16 px of disparity, whole as texture without blur is
constexpr double kFar_m = 60.0;       // depth of everything else, beyond the field
constexpr double kRangeShare = 0.02;  // a third of a pixel of disparity, and the bins of the histogram
constexpr double kBoardHalf_m = 1.0;  // of its width
constexpr double kBoardTop_m = 1.6;

StereoCamera camera() {
  StereoCamera c;
  c.fx_px = c.fy_px = 400;
  c.cx_px = c.cx_right_px = 200;
  c.cy_px = 100;
  c.baseline_m = 0.5;
  c.width_px = 400;
  c.height_px = 200;
  return c;
}

/// Random texture: what the ray through column u and row v of a camera at lateral place `eye_y_m` meets.
std::uint8_t grey(double eye_y_m, int u, int v) {
  const StereoCamera c = camera();
  const auto texture = [](double a, double b, double cell_m, std::uint32_t surface) {
    const auto word = [&](double k) {
      return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(k / cell_m)));
    };
    return static_cast<std::uint8_t>(philox({word(a), word(b), surface, 0}, 3)[0] >> 24);
  };
  const auto left_m = [&](double depth_m) { return eye_y_m + (c.cx_px - u) / c.fx_px * depth_m; };
  const auto up_m = [&](double depth_m) { return c.mount.height_m + (c.cy_px - v) / c.fy_px * depth_m; };
  const bool on_board =
      std::abs(left_m(kBoard_m)) <= kBoardHalf_m && up_m(kBoard_m) >= 0 && up_m(kBoard_m) <= kBoardTop_m;
  if (on_board) return texture(left_m(kBoard_m), up_m(kBoard_m), 0.06, 1);
  return texture(left_m(kFar_m), up_m(kFar_m), 0.3, 2);
}

GrayImage image(double eye_y_m) {
  GrayImage result{camera().width_px, camera().height_px, {}};
  for (int v = 0; v < result.height_px; ++v)
    for (int u = 0; u < result.width_px; ++u) result.pixels.push_back(grey(eye_y_m, u, v));
  return result;
}

struct DetectDensely : ::testing::TestWithParam<DenseMatcher> {
  DetectDensely() { options.road.estimate = false; }
  GrayPair pair{image(0.0), image(-camera().baseline_m)};
  DetectorOptions options;
};

TEST_P(DetectDensely, FindsABoardAtItsRange) {
  const DenseDetection dense = detect_densely(pair.view(), camera(), GetParam(), options);
  EXPECT_GT(dense.points, 100u);  // the board covers 67 by 53 pixels, a sixteenth of which are kept
  ASSERT_FALSE(dense.obstacles.empty());
  for (const auto& obstacle : dense.obstacles) {
    EXPECT_NEAR(obstacle.x_m, kBoard_m, kRangeShare * kBoard_m);
    EXPECT_LE(std::abs(obstacle.y_m), kBoardHalf_m);
  }
}

TEST_P(DetectDensely, HasTheDisparityOfTheBoardsPixels) {
  const auto disparity_px = dense_disparity(pair.view(), camera(), GetParam(), 5.0);
  ASSERT_EQ(disparity_px.size(), 400U * 200U);
  // The middle of the board; its disparity is 16 px, that of what is behind it 3.3.
  EXPECT_NEAR(disparity_px[128 * 400 + 200], 16.0, 0.25);
  EXPECT_NEAR(disparity_px[40 * 400 + 200], 400 * 0.5 / kFar_m, 1.0) << "unblurred texture moves by whole pixels";
  EXPECT_TRUE(std::isnan(disparity_px[40 * 400])) << "the right image does not show it";
}

TEST_P(DetectDensely, ScansTheBoard) {
  const DenseDetection dense = detect_densely(pair.view(), camera(), GetParam(), options);
  const Scan scan = dense_scan(dense.ranges, 25);
  int obstacles = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (scan.states[i] != SectorState::obstacle || scan.ranges_m[i] > 30.0) continue;
    ++obstacles;
    EXPECT_NEAR(scan.ranges_m[i] * std::cos(scan.angle_rad(i)), kBoard_m, kRangeShare * kBoard_m);
    EXPECT_LE(std::abs(scan.ranges_m[i] * std::sin(scan.angle_rad(i))), kBoardHalf_m + 0.2);
  }
  EXPECT_GE(obstacles, 15);  // the board is 9 degrees wide, 18 sectors
  const Scan free = dense_scan(dense.ranges, 10000);
  ASSERT_EQ(free.size(), scan.size());
  for (const auto state : free.states) EXPECT_EQ(state, SectorState::free);
}

TEST_P(DetectDensely, MatchesTheFirstColumnsButNotWhatTheRightImageLacks) {
  // A wall at the board's depth over the whole picture: 16 px of disparity, so 16 columns have no match.
  const auto wall = [](double eye_y_m) {
    GrayImage picture{camera().width_px, camera().height_px, {}};
    for (int v = 0; v < picture.height_px; ++v) {
      for (int u = 0; u < picture.width_px; ++u) {
        const double y_m = eye_y_m + (camera().cx_px - u) / camera().fx_px * kBoard_m;
        const auto cell = static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(y_m / 0.06)));
        picture.pixels.push_back(
            static_cast<std::uint8_t>(philox({cell, static_cast<std::uint32_t>(v / 2), 0, 0}, 3)[0] >> 24));
      }
    }
    return picture;
  };
  const GrayPair walls{wall(0.0), wall(-camera().baseline_m)};
  const DenseDetection dense = detect_densely(walls.view(), camera(), GetParam(), options);
  const auto& sectors = dense.ranges.of_sector_m;
  // Column 24, which unpadded matching over 64 disparities leaves out.
  const auto seen = dense.ranges.bearings.sector_of(std::atan((camera().cx_px - 24) / camera().fx_px));
  ASSERT_TRUE(seen.has_value());
  EXPECT_GT(sectors[*seen].size(), 25u);
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < sectors.size(); ++i)
    if (camera().cx_px - camera().fx_px * std::tan(dense.ranges.bearings.angle_rad(i)) < 14)
      for (const double range_m : sectors[i]) beyond += std::abs(range_m - kBoard_m) < 1.0;
  EXPECT_EQ(beyond, 0u);
}

TEST_P(DetectDensely, HasALeastScoreOfItsOwn) {
  // Points weigh 1: no obstacle has more than all of them.
  options.concentrate.assemble.min_score = 2.0;
  EXPECT_FALSE(detect_densely(pair.view(), camera(), GetParam(), options).obstacles.empty());
  DenseOptions dense;
  dense.min_score = 2.0;
  EXPECT_TRUE(detect_densely(pair.view(), camera(), GetParam(), options, dense).obstacles.empty());
}

TEST_P(DetectDensely, GivesTheSameTwice) {
  const auto first = detect_densely(pair.view(), camera(), GetParam(), options);
  const auto second = detect_densely(pair.view(), camera(), GetParam(), options);
  ASSERT_FALSE(first.obstacles.empty());
  ASSERT_EQ(first.obstacles.size(), second.obstacles.size());
  for (std::size_t i = 0; i < first.obstacles.size(); ++i) EXPECT_EQ(first.obstacles[i].x_m, second.obstacles[i].x_m);
}

TEST_P(DetectDensely, FindsTheBoardWithPrincipalPointsApart) {
  // Shifting the right picture moves its principal point; all disparities change, the scene does not.
  constexpr int kShift_px = 30;
  GrayImage shifted = pair.right;
  for (int v = 0; v < shifted.height_px; ++v)
    for (int u = 0; u < shifted.width_px; ++u)
      shifted.pixels[static_cast<std::size_t>(v * shifted.width_px + u)] = grey(-camera().baseline_m, u - kShift_px, v);
  StereoCamera c = camera();
  c.cx_right_px += kShift_px;
  const DenseDetection dense = detect_densely({pair.left.view(), shifted.view()}, c, GetParam(), options);
  ASSERT_FALSE(dense.obstacles.empty());
  EXPECT_NEAR(dense.obstacles[0].x_m, kBoard_m, kRangeShare * kBoard_m);
}

TEST_P(DetectDensely, RefusesPairsThatDoNotFit) {
  StereoCamera other = camera();
  other.width_px = 640;
  EXPECT_THROW(detect_densely(pair.view(), other, GetParam(), options), InputError);
  EXPECT_THROW(detect_densely({}, camera(), GetParam(), options), InputError);
}

TEST_P(DetectDensely, ChecksItsOptions) {
  EXPECT_THROW(detect_densely(pair.view(), camera(), GetParam(), options, {.step_px = 0}), InputError);
  EXPECT_THROW(detect_densely(pair.view(), camera(), GetParam(), options, {}, {}, 0.0), InputError);
  DetectorOptions nowhere = options;
  nowhere.field.x_min_m = 0.0;
  EXPECT_THROW(detect_densely(pair.view(), camera(), GetParam(), nowhere), InputError);
  EXPECT_THROW(dense_disparity(pair.view(), camera(), GetParam(), 0.0), InputError);
}

INSTANTIATE_TEST_SUITE_P(Matchers, DetectDensely, ::testing::Values(DenseMatcher::sgbm, DenseMatcher::sgbm_3way),
                         [](const auto& row) { return row.param == DenseMatcher::sgbm ? "Sgbm" : "Sgbm3Way"; });

}  // namespace
}  // namespace flies
