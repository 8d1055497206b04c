#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "flies/draw/draw.hpp"

namespace flies {
namespace {

const cv::Vec3b kAsphalt(90, 90, 90);
const cv::Mat kStreet(240, 720, CV_8UC3, cv::Scalar(90, 90, 90));

StereoCamera street_camera() {
  return {.fx_px = 400,
          .fy_px = 400,
          .cx_px = 360,
          .cx_right_px = 360,
          .cy_px = 60,
          .baseline_m = 0.5,
          .width_px = 720,
          .height_px = 240,
          .mount = {}};
}

/// Three wide sectors: to the right an obstacle 12 m away before which 10 m are free, ahead 20 m free, to the left
/// unknown.
Scan three_sectors() {
  Scan scan;
  scan.angle_min_rad = -0.2;
  scan.angle_increment_rad = 0.2;
  scan.ranges_m = {12.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  scan.free_m = {10.0, 20.0, 30.0};
  scan.confidence = {1.0, 1.0, 0.0};
  scan.states = {SectorState::obstacle, SectorState::free, SectorState::unknown};
  return scan;
}

constexpr double kRight_rad = -0.2, kAhead_rad = 0.0, kLeft_rad = 0.2;

bool is_green(const cv::Vec3b& bgr) { return bgr[1] > bgr[0] + 20 && bgr[1] > bgr[2] + 20; }

/// A small square of the picture around a place.
cv::Mat around(const cv::Mat& picture, cv::Point place) {
  constexpr int kHalf_px = 5;
  return picture(cv::Rect(place.x - kHalf_px, place.y - kHalf_px, 2 * kHalf_px + 1, 2 * kHalf_px + 1));
}

int count_other_than(const cv::Mat& image, const cv::Vec3b& color) {
  int count = 0;
  for (auto pixel = image.begin<cv::Vec3b>(); pixel != image.end<cv::Vec3b>(); ++pixel) count += *pixel != color;
  return count;
}

struct OverlayOfAScan : ::testing::Test {
  cv::Mat picture = draw_overlay(kStreet, {}, {}, {three_sectors(), street_camera(), {}});
  cv::Point on_road(double range_m, double angle_rad) const {
    const Projection projection(street_camera());
    const StereoPoint at = projection.project({range_m * std::cos(angle_rad), range_m * std::sin(angle_rad), 0});
    return {static_cast<int>(std::lround(at.u_px)), static_cast<int>(std::lround(at.v_px))};
  }
  cv::Vec3b color(double range_m, double angle_rad) const { return picture.at<cv::Vec3b>(on_road(range_m, angle_rad)); }
};

TEST_F(OverlayOfAScan, TintsTheRoadUpToWhereItIsFree) {
  EXPECT_TRUE(is_green(color(6, kAhead_rad)));
  EXPECT_TRUE(is_green(color(17, kAhead_rad)));
  EXPECT_EQ(color(25, kAhead_rad), kAsphalt);
  EXPECT_TRUE(is_green(color(8, kRight_rad)));
  EXPECT_EQ(color(12, kRight_rad), kAsphalt) << "up to the obstacle but not seen free";
}

TEST_F(OverlayOfAScan, LeavesWhatIsAboveTheRoadAsItIs) {
  EXPECT_EQ(picture.at<cv::Vec3b>(30, 360), kAsphalt);
  EXPECT_EQ(count_other_than(picture(cv::Rect(0, 0, 720, 60)), kAsphalt), 0);
}

TEST_F(OverlayOfAScan, HatchesTheFootOfUnknownSectors) {
  const cv::Mat foot = around(picture, on_road(6, kLeft_rad));
  const int hatched = count_other_than(foot, kAsphalt);
  EXPECT_GT(hatched, 0.2 * static_cast<double>(foot.total()));
  EXPECT_LT(hatched, 0.8 * static_cast<double>(foot.total()));
  for (auto pixel = foot.begin<cv::Vec3b>(); pixel != foot.end<cv::Vec3b>(); ++pixel)
    EXPECT_FALSE(is_green(*pixel)) << "unknown is not free, whatever was seen before it";
}

TEST_F(OverlayOfAScan, FollowsTheRoadThatWasFitted) {
  // A road that rises by 5 % shows what is 17 m away higher up in the image, where the nominal one would be far away.
  const RoadPlane rising{.height_m = 0, .slope = 0.05, .bank = 0};
  const cv::Mat steep = draw_overlay(kStreet, {}, {}, {three_sectors(), street_camera(), rising});
  const Projection projection(street_camera());
  const StereoPoint at = projection.project({17, 0, rising.z_m(17, 0)});
  const cv::Point place(static_cast<int>(at.u_px), static_cast<int>(at.v_px));
  EXPECT_TRUE(is_green(steep.at<cv::Vec3b>(place)));
  EXPECT_FALSE(is_green(picture.at<cv::Vec3b>(place)));
}

TEST(DrawOverlay, DrawsNothingOfAnEmptyScan) {
  const cv::Mat plain = draw_overlay(kStreet, {}, {});
  EXPECT_EQ(cv::norm(plain, draw_overlay(kStreet, {}, {}, {{}, street_camera(), {}}), cv::NORM_L1), 0);
  EXPECT_EQ(count_other_than(plain(cv::Rect(0, 0, 720, 240)), kAsphalt), 0);
}

TEST(DrawOverlay, TakesAScanOnOddImages) {
  for (const cv::Mat& image : {cv::Mat(), cv::Mat(1, 1, CV_8UC1, cv::Scalar(3)), cv::Mat(200, 1, CV_8UC3)})
    EXPECT_FALSE(draw_overlay(image, {}, {}, {three_sectors(), street_camera(), {}}).empty());
}

struct TopViewOfAScan : ::testing::Test {
  TopView view{.max_x_m = 40, .half_width_m = 12, .pixels_per_m = 10};
  cv::Mat plain = draw_top_view(street_camera(), {}, {}, {}, view);
  cv::Mat picture = draw_top_view(street_camera(), {}, {}, {}, view, three_sectors());
  static cv::Point place(double range_m, double angle_rad) {
    constexpr double kPlotLeft_px = 58, kPlotTop_px = 34;
    return {static_cast<int>(kPlotLeft_px + (12 - range_m * std::sin(angle_rad)) * 10),
            static_cast<int>(kPlotTop_px + (40 - range_m * std::cos(angle_rad)) * 10)};
  }
};

TEST_F(TopViewOfAScan, FillsTheFreeGround) {
  for (const auto& [range_m, angle_rad] : {std::pair{12.0, 0.03}, {18.0, -0.03}, {8.0, -0.17}}) {
    EXPECT_TRUE(is_green(picture.at<cv::Vec3b>(place(range_m, angle_rad)))) << range_m << " m";
    EXPECT_FALSE(is_green(plain.at<cv::Vec3b>(place(range_m, angle_rad))));
  }
  EXPECT_EQ(cv::norm(around(picture, place(23, 0.03)), around(plain, place(23, 0.03))), 0) << "beyond the free ground";
}

TEST_F(TopViewOfAScan, DrawsADarkLineWhereAnObstacleEndsTheSector) {
  const cv::Vec3b end = picture.at<cv::Vec3b>(place(12.0, kRight_rad));
  EXPECT_LT(end[0] + end[1] + end[2], 3 * 100);
  EXPECT_GT(plain.at<cv::Vec3b>(place(12.0, kRight_rad))[0], 200);
}

TEST_F(TopViewOfAScan, HatchesUnknownSectors) {
  const cv::Mat foot = around(picture, place(7, 0.2)), bare = around(plain, place(7, 0.2));
  cv::Mat changed;
  cv::absdiff(foot, bare, changed);
  const int hatched = count_other_than(changed, {0, 0, 0});
  EXPECT_GT(hatched, 0.2 * static_cast<double>(foot.total()));
  EXPECT_LT(hatched, 0.8 * static_cast<double>(foot.total()));
}

TEST_F(TopViewOfAScan, SaysInItsLegendWhatTheColoursMean) {
  const cv::Rect legend(58 + 240 + 5, 34, picture.cols - 58 - 240 - 5, 300);
  const auto greens_in = [&](const cv::Mat& canvas) {
    const cv::Mat part = canvas(legend);
    return std::count_if(part.begin<cv::Vec3b>(), part.end<cv::Vec3b>(), is_green);
  };
  constexpr int kSample_px = 14 * 14;  // of what was seen free
  EXPECT_GE(greens_in(picture) - greens_in(plain), kSample_px / 2);
}

}  // namespace
}  // namespace flies
