#include "flies/propose/propose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "flies/core/error.hpp"

namespace flies {
namespace {

using testing::IsEmpty;
using testing::Not;

constexpr int kWidth_px = 1242, kHeight_px = 375;
/// Geometry is exact but for the tilt of an upright person under a pitched camera.
constexpr double kTolerance_px = 0.01;

StereoCamera street_camera() { return {720.0, 720.0, 610.0, 610.0, 173.0, 0.54, kWidth_px, kHeight_px, {}}; }

Obstacle person_at(double x_m, double y_m) {
  Obstacle obstacle;
  obstacle.x_m = x_m;
  obstacle.y_m = y_m;
  obstacle.range_m = std::hypot(x_m, y_m);
  obstacle.width_m = 0.6;
  obstacle.height_m = 1.7;
  return obstacle;
}

/// One box of one height, on the road, at the obstacle itself.
ProposeOptions single_box(double height_m) {
  ProposeOptions options;
  options.min_height_m = options.max_height_m = height_m;
  options.heights = 1;
  options.lateral_margin_m = options.max_lateral_m = 0.0;
  options.vertical_shifts = 0;
  return options;
}

std::vector<Roi> propose(const std::vector<Obstacle>& obstacles, const ProposeOptions& options = {},
                         const RoadPlane& road = {}, const StereoCamera& camera = street_camera()) {
  return propose_rois(obstacles, {}, Projection(camera), road, kWidth_px, kHeight_px, options);
}

double centre_u_px(const ImageBox& box) { return box.u_px + box.width_px / 2.0; }
double bottom_px(const ImageBox& box) { return box.v_px + box.height_px; }

TEST(ProposeRois, IsEmptyWithoutObstacles) { EXPECT_THAT(propose({}), IsEmpty()); }

TEST(ProposeRois, PutsFeetOnTheRoadAndHeadAtItsHeight) {
  const auto rois = propose({person_at(10.0, 2.0)}, single_box(1.8));
  ASSERT_EQ(rois.size(), 1U);
  const Roi& roi = rois.front();
  EXPECT_NEAR(bottom_px(roi.person), 173.0 + 720.0 * 1.65 / 10.0, kTolerance_px);
  EXPECT_NEAR(roi.person.v_px, 173.0 + 720.0 * (1.65 - 1.8) / 10.0, kTolerance_px);
  EXPECT_NEAR(centre_u_px(roi.person), 610.0 - 720.0 * 2.0 / 10.0, kTolerance_px);
  EXPECT_DOUBLE_EQ(roi.x_m, 10.0);
  EXPECT_DOUBLE_EQ(roi.y_m, 2.0);
  EXPECT_DOUBLE_EQ(roi.height_m, 1.8);
}

TEST(ProposeRois, FollowsARisingRoadAndAPitchedCamera) {
  StereoCamera camera = street_camera();
  camera.mount.pitch_rad = radians(2.0);
  const RoadPlane road{0.05, 0.02, 0.01};
  const auto rois = propose({person_at(12.0, -3.0)}, single_box(1.5), road, camera);
  ASSERT_EQ(rois.size(), 1U);
  const double road_m = 0.05 + 0.02 * 12.0 - 0.01 * 3.0;
  const Projection projection(camera);
  EXPECT_NEAR(bottom_px(rois[0].person), projection.project({12.0, -3.0, road_m}).v_px, kTolerance_px);
  EXPECT_NEAR(rois[0].person.v_px, projection.project({12.0, -3.0, road_m + 1.5}).v_px, kTolerance_px);
}

TEST(ProposeRois, GivesWindowsOfOneToTwoWithTheMarginOfTheTraining) {
  ProposeOptions options;
  options.person_share = 0.75;
  const auto rois = propose({person_at(9.0, 1.0), person_at(15.0, -4.0)}, options);
  ASSERT_THAT(rois, Not(IsEmpty()));
  for (const Roi& roi : rois) {
    EXPECT_NEAR(roi.window.height_px, 2.0 * roi.window.width_px, kTolerance_px);
    EXPECT_NEAR(roi.person.height_px, 0.75 * roi.window.height_px, kTolerance_px);
    EXPECT_NEAR(centre_u_px(roi.person), centre_u_px(roi.window), kTolerance_px);
    EXPECT_NEAR(roi.person.v_px - roi.window.v_px, bottom_px(roi.window) - bottom_px(roi.person), kTolerance_px);
  }
}

TEST(ProposeRois, SpansTheHeightsInEqualRatios) {
  ProposeOptions options = single_box(1.0);
  options.max_height_m = 2.25;
  options.heights = 3;
  const auto rois = propose({person_at(8.0, 0.0)}, options);
  ASSERT_EQ(rois.size(), 3U);
  EXPECT_NEAR(rois[0].height_m, 1.0, 1e-12);
  EXPECT_NEAR(rois[1].height_m, 1.5, 1e-12);
  EXPECT_NEAR(rois[2].height_m, 2.25, 1e-12);
}

TEST(ProposeRois, StepsAcrossTheLineOfSightAtOneRange) {
  ProposeOptions options = single_box(1.6);
  options.max_lateral_m = 0.6;
  options.person_share = 0.8;
  options.step = 0.1;  // of a window of 2 m
  Obstacle wide = person_at(8.0, 4.0);
  wide.width_m = 5.0;
  const auto rois = propose({wide}, options);
  ASSERT_EQ(rois.size(), 7U) << "0, 0.2, -0.2, 0.4, -0.4, 0.6, -0.6 m, then the cap";
  std::set<long> offsets_mm;
  for (const Roi& roi : rois) {
    const double along_m = (roi.x_m * wide.x_m + roi.y_m * wide.y_m) / wide.range_m;
    const double left_m = (roi.y_m * wide.x_m - roi.x_m * wide.y_m) / wide.range_m;
    EXPECT_NEAR(along_m, wide.range_m, 1e-9) << "stays across the line of sight";
    offsets_mm.insert(std::lround(left_m * 1000.0));
  }
  EXPECT_EQ(offsets_mm, (std::set<long>{-600, -400, -200, 0, 200, 400, 600}));
}

TEST(ProposeRois, PutsTheBoxesOfAHeightOnARaster) {
  ProposeOptions options;
  options.merge_step = 0.0;
  const auto rois = propose({person_at(8.0, 2.0)}, options);
  std::map<double, ImageBox> first;  // by height
  for (const Roi& roi : rois) {
    const ImageBox& origin = first.emplace(roi.height_m, roi.window).first->second;
    const double stride_px = origin.height_px / 12.0;
    const double across = (roi.window.u_px - origin.u_px) / stride_px,
                 down = (roi.window.v_px - origin.v_px) / stride_px;
    EXPECT_NEAR(across, std::round(across), 1e-9);
    EXPECT_NEAR(down, std::round(down), 1e-9);
    EXPECT_DOUBLE_EQ(roi.window.height_px, origin.height_px);
  }
  EXPECT_EQ(first.size(), static_cast<std::size_t>(options.heights));
}

TEST(ProposeRois, ShiftsUpAndDownBySharesOfTheWindow) {
  ProposeOptions options = single_box(1.7);
  options.vertical_shifts = 1;
  options.step = 0.1;
  const auto rois = propose({person_at(10.0, 0.0)}, options);
  ASSERT_EQ(rois.size(), 3U);
  const double window_px = rois[0].window.height_px;
  EXPECT_NEAR(rois[1].person.v_px - rois[0].person.v_px, 0.1 * window_px, kTolerance_px);
  EXPECT_NEAR(rois[2].person.v_px - rois[0].person.v_px, -0.1 * window_px, kTolerance_px);
  EXPECT_NEAR(rois[1].window.v_px - rois[0].window.v_px, 0.1 * window_px, kTolerance_px);
}

TEST(ProposeRois, KeepsTheOrderOfObstaclesAndNamesThem) {
  const auto rois = propose({person_at(8.0, 2.0), person_at(12.0, -3.0)}, single_box(1.7));
  ASSERT_EQ(rois.size(), 2U);
  EXPECT_EQ(rois[0].obstacle, 0U);
  EXPECT_EQ(rois[1].obstacle, 1U);
}

TEST(ProposeRois, MergesLikeWindowsOfTwoObstacles) {
  const std::vector<Obstacle> twice{person_at(10.0, 0.0), person_at(10.0, 0.0)};
  ProposeOptions options = single_box(1.7);
  EXPECT_EQ(propose(twice, options).size(), 1U);
  options.merge_step = 0.0;
  EXPECT_EQ(propose(twice, options).size(), 2U);
}

TEST(ProposeRois, SkipsLowObstaclesButIsLenient) {
  Obstacle kerb = person_at(10.0, 0.0), badly_measured = kerb;
  kerb.height_m = 0.3;
  badly_measured.height_m = 0.8;
  EXPECT_THAT(propose({kerb}), IsEmpty());
  EXPECT_THAT(propose({badly_measured}), Not(IsEmpty()));
}

TEST(ProposeRois, SkipsPersonsTooSmallToTell) {
  ProposeOptions options = single_box(1.7);
  options.min_person_px = 50.0;  // 1.7 m * 720 px at 24.48 m
  EXPECT_EQ(propose({person_at(24.0, 0.0)}, options).size(), 1U);
  EXPECT_EQ(propose({person_at(25.0, 0.0)}, options).size(), 0U);
}

TEST(ProposeRois, SkipsPersonsWhollyOutsideTheImageAndKeepsCutOnes) {
  const ProposeOptions options = single_box(1.7);
  EXPECT_THAT(propose({person_at(5.0, 6.0)}, options), IsEmpty());
  const auto cut = propose({person_at(5.0, 4.2)}, options);  // u = 610 - 720 * 4.2 / 5 = 5 px
  ASSERT_EQ(cut.size(), 1U);
  EXPECT_LT(cut[0].person.u_px, 0.0);
}

TEST(ProposeRois, IgnoresObstaclesBehindTheCameraOrNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Obstacle no_height = person_at(10.0, 0.0), no_width = no_height;
  no_height.height_m = nan;
  no_width.width_m = nan;
  EXPECT_THAT(propose({person_at(-5.0, 0.0), person_at(0.0, 0.0), person_at(nan, 1.0), person_at(5.0, nan), no_height,
                       no_width}),
              IsEmpty());
}

TEST(ProposeRois, NeverExceedsItsBound) {
  ProposeOptions options;
  options.merge_step = 0.0;
  Obstacle wall = person_at(7.0, 0.0);
  wall.width_m = 100.0;
  EXPECT_EQ(propose({wall}, options).size(), max_rois_per_obstacle(options));
}

TEST(ProposeRois, RejectsHeightsInTheWrongOrder) {
  ProposeOptions options;
  options.min_height_m = 2.0;
  options.max_height_m = 1.0;
  EXPECT_THROW(propose({person_at(10.0, 0.0)}, options), InputError);
}

TEST(ProposeRois, SurvivesAnImageOfOnePixel) {
  EXPECT_THAT(propose_rois(std::vector{person_at(10.0, 0.0)}, {}, Projection(street_camera()), {}, 1, 1, {}),
              IsEmpty());
}

TEST(ProposeRois, LooksAtSurfacesOfTheScanAfterTheObstacles) {
  Scan scan;
  scan.angle_min_rad = 0.2;
  scan.angle_increment_rad = 0.02;
  scan.ranges_m = {12.0};
  scan.free_m = {0.0};
  scan.confidence = {1.0};
  scan.states = {SectorState::obstacle};
  const auto rois = propose_rois(std::vector{person_at(10.0, -3.0)}, scan, Projection(street_camera()), {}, kWidth_px,
                                 kHeight_px, single_box(1.7));
  ASSERT_EQ(rois.size(), 2U);
  EXPECT_EQ(rois[0].obstacle, 0U);
  EXPECT_EQ(rois[1].obstacle, 1U);
  EXPECT_NEAR(std::atan2(rois[1].y_m, rois[1].x_m), 0.2, 1e-9);
  EXPECT_NEAR(std::hypot(rois[1].x_m, rois[1].y_m), 12.0, 1e-9);
}

TEST(ProposeRois, RefusesStepsThatNoNumberOfBoxesCounts) {
  for (const double step : {1e-300, 1e-12, 1e-7}) {
    ProposeOptions options;
    options.step = step;
    EXPECT_THROW(propose({person_at(10.0, 0.0)}, options), InputError) << step;
  }
}

TEST(ProposeRois, MergesNothingByASteplessGrid) {
  ProposeOptions keep_all, tiny;
  keep_all.merge_step = 0.0;
  tiny.merge_step = 1e-300;
  EXPECT_EQ(propose({person_at(10.0, 0.0)}, tiny).size(), propose({person_at(10.0, 0.0)}, keep_all).size());
}

}  // namespace
}  // namespace flies
