#include "flies/draw/draw.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

namespace flies {
namespace {

const cv::Mat kStreet(120, 500, CV_8UC1, cv::Scalar(90));

StereoCamera street_camera() {
  return {.fx_px = 400,
          .fy_px = 400,
          .cx_px = 250,
          .cx_right_px = 250,
          .cy_px = 60,
          .baseline_m = 0.5,
          .width_px = 500,
          .height_px = 120,
          .mount = {}};
}

Obstacle obstacle_at(double x_m, double y_m, ImageBox box = {100, 30, 40, 60}) {
  return {.x_m = x_m,
          .y_m = y_m,
          .range_m = std::hypot(x_m, y_m),
          .width_m = 2.0,
          .height_m = 1.5,
          .ground_z_m = 0,
          .score = 1,
          .box = box};
}

Pedestrian pedestrian_at(double x_m, double y_m, ImageBox box = {200, 30, 20, 50}) {
  return {.x_m = x_m, .y_m = y_m, .range_m = std::hypot(x_m, y_m), .height_m = 1.7, .probability = 1, .box = box};
}

bool is_red(const cv::Vec3b& bgr) { return bgr[2] > 150 && bgr[0] < 80 && bgr[1] < 110; }
bool is_blue(const cv::Vec3b& bgr) { return bgr[0] > 150 && bgr[2] < 110; }
bool is_pedestrian(const cv::Vec3b& bgr) { return bgr == cv::Vec3b(255, 0, 255); }

template <class Test>
int count(const cv::Mat& image, const Test& test) {
  return static_cast<int>(std::count_if(image.begin<cv::Vec3b>(), image.end<cv::Vec3b>(), test));
}

Population three_flies() {
  Population flies;
  flies.push_back({10, 0, 1}, 0.0F);
  flies.push_back({20, 2, 1}, 5.0F);
  flies.push_back({30, -3, 0}, 10.0F);
  return flies;
}

TEST(RangeColor, GoesFromRedToBlue) {
  const auto near = range_color(0), far = range_color(40);
  EXPECT_GT(near[2], near[0] + 100);
  EXPECT_GT(far[0], far[2] + 100);
  EXPECT_EQ(range_color(500), far);
}

TEST(DrawOverlay, DrawsTheBoxOfANearObstacleInRed) {
  const cv::Mat picture = draw_overlay(kStreet, {obstacle_at(3, 0)}, {});
  ASSERT_EQ(picture.type(), CV_8UC3);
  EXPECT_EQ(picture.cols, kStreet.cols);
  EXPECT_GT(picture.rows, kStreet.rows);
  for (const cv::Point corner : {cv::Point(100, 30), {100, 60}, {139, 89}})
    EXPECT_TRUE(is_red(picture.at<cv::Vec3b>(corner))) << corner;
  EXPECT_EQ(picture.at<cv::Vec3b>(110, 300), cv::Vec3b(90, 90, 90)) << "the image must show elsewhere";
}

TEST(DrawOverlay, DrawsPedestriansInTheirOwnColor) {
  const cv::Mat picture = draw_overlay(kStreet, {}, {pedestrian_at(10, 0)});
  EXPECT_TRUE(is_pedestrian(picture.at<cv::Vec3b>(50, 200)));
  EXPECT_EQ(count(draw_overlay(kStreet, {}, {})(cv::Rect(0, 0, 500, 120)), is_pedestrian), 0);
}

TEST(DrawOverlay, KeepsColorOfColorImages) {
  const cv::Mat sky(120, 500, CV_8UC3, cv::Scalar(200, 100, 50));
  EXPECT_EQ(draw_overlay(sky, {}, {}).at<cv::Vec3b>(5, 5), cv::Vec3b(200, 100, 50));
}

TEST(DrawOverlay, TakesBoxesOutsideAndNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const cv::Mat picture = draw_overlay(
      kStreet, {obstacle_at(3, 0, {-1e12, -50, 2e12, 500}), obstacle_at(nan, nan, {nan, nan, nan, nan})}, {});
  EXPECT_EQ(picture.cols, kStreet.cols);
}

TEST(DrawTopView, PutsObstacleWhereItStands) {
  const TopView view{.max_x_m = 40, .half_width_m = 10, .pixels_per_m = 10};
  const cv::Mat empty = draw_top_view(street_camera(), {}, {}, {}, view);
  const cv::Mat picture = draw_top_view(street_camera(), {}, {obstacle_at(4, 3)}, {}, view);
  // The only pixels that differ from the empty view are around (4 m, 3 m): left of the middle, near the bottom.
  cv::Mat changed;
  cv::absdiff(picture, empty, changed);
  double sum_u = 0, sum_v = 0, n = 0;
  for (int v = 0; v < changed.rows; ++v)
    for (int u = 0; u < changed.cols; ++u)
      if (is_red(picture.at<cv::Vec3b>(v, u)) && changed.at<cv::Vec3b>(v, u) != cv::Vec3b()) {
        sum_u += u;
        sum_v += v;
        ++n;
      }
  ASSERT_GT(n, 20);
  constexpr double kLabelAndBarDepth_px = 8;  // the bar extends behind its position and its label may cover a part
  constexpr double kPlotLeft_px = 58, kPlotTop_px = 34;
  EXPECT_NEAR(sum_u / n, kPlotLeft_px + (10 - 3) * 10, kLabelAndBarDepth_px);
  EXPECT_NEAR(sum_v / n, kPlotTop_px + (40 - 4) * 10, kLabelAndBarDepth_px);
}

TEST(DrawTopView, ShowsPedestriansAndFlies) {
  const cv::Mat without = draw_top_view(street_camera(), {}, {}, {});
  const cv::Mat with = draw_top_view(street_camera(), {}, {}, {pedestrian_at(10, 0)});
  EXPECT_GT(count(with, is_pedestrian), count(without, is_pedestrian) + 20);
  EXPECT_GT(cv::norm(without, draw_top_view(street_camera(), three_flies(), {}, {}), cv::NORM_L1), 0);
}

TEST(DrawFlies, ColorsStrongFliesRedAndWeakOnesBlue) {
  Population flies;
  flies.push_back({20, 2, 1}, 0.001F);
  for (int i = 0; i < 5; ++i) flies.push_back({20, -2, 1}, 10.0F);
  const cv::Mat picture = draw_flies(kStreet, flies, street_camera(), "Eq. (2)");
  const Projection projection(street_camera());
  const auto pixel_at = [&](double y_m) {
    const StereoPoint at = projection.project({20, y_m, 1});
    return picture.at<cv::Vec3b>(cv::Point(static_cast<int>(std::lround(at.u_px)), static_cast<int>(at.v_px)));
  };
  EXPECT_TRUE(is_red(pixel_at(-2)));
  EXPECT_TRUE(is_blue(pixel_at(2)));
}

TEST(DrawFitnessComparison, IsTwoColumnsWide) {
  const std::vector<TitledFlies> columns = {{"Eq. (1)", three_flies()}, {"Eq. (2)", three_flies()}};
  const cv::Mat one = draw_fitness_comparison(kStreet, street_camera(), std::span(columns).first(1));
  const cv::Mat both = draw_fitness_comparison(kStreet, street_camera(), columns);
  EXPECT_GE(both.cols, 2 * one.cols);
  EXPECT_EQ(both.rows, one.rows);
}

TEST(DrawHistogram, PutsTheHighestBarAtItsRange) {
  HistogramPlot plot{
      .title = "Eq. (2)", .view_angle = {}, .axis = {.min_m = 0, .bin_m = 1}, .marked_x_m = {}, .mark_label = {}};
  plot.view_angle.votes.assign(40, 0.0);
  plot.view_angle.votes[30] = 2.0;
  const cv::Mat picture = draw_histogram(plot);
  const cv::Vec3b bar(200, 150, 70);
  double sum_u = 0, n = 0;
  for (int u = 0; u < picture.cols; ++u)
    if (picture.at<cv::Vec3b>(200, u) == bar) sum_u += u, ++n;
  ASSERT_GT(n, 5);
  EXPECT_GT(sum_u / n, picture.cols * 0.7) << "30.5 m of 40 m lies right of the middle";
}

TEST(DrawHistogram, MarksSampleAndObject) {
  HistogramPlot plot;
  plot.view_angle.votes = {1, 2, 3};
  const cv::Mat plain = draw_histogram(plot);
  plot.view_angle.samples = {{1.25, 0}};
  plot.marked_x_m = 1.1;
  const cv::Mat marked = draw_histogram(plot);
  EXPECT_EQ(count(plain, is_pedestrian), 0);
  EXPECT_GT(count(marked, is_pedestrian), 100);
  EXPECT_EQ(draw_histograms(std::vector{plot, plot}).cols, 2 * marked.cols);
}

TEST(DrawConcentrating, PutsAGreenDiscOnWhatWasKeptAndARedCrossOnWhatWasNot) {
  ConcentrateResult result;
  result.shifted.push_back({{300, 60}, {320, 60}});
  result.candidates.push_back({{320, 60}, {10, 0}, 1.0, true});
  result.candidates.push_back({{350, 60}, {10, 0}, 1.0, false});
  const cv::Mat picture = draw_concentrating(kStreet, result);
  EXPECT_EQ(picture.at<cv::Vec3b>(60, 320), (cv::Vec3b{60, 200, 0}));
  EXPECT_TRUE(is_red(picture.at<cv::Vec3b>(60, 350)));
}

TEST(DrawAll, TakeEmptyInputsAndOnePixelWideImages) {
  for (const cv::Mat& image : {cv::Mat(), cv::Mat(1, 1, CV_8UC1, cv::Scalar(3)), cv::Mat(200, 1, CV_8UC3)}) {
    EXPECT_FALSE(draw_overlay(image, {}, {}).empty());
    EXPECT_FALSE(draw_overlay(image, {obstacle_at(3, 0)}, {pedestrian_at(4, 0)}).empty());
    EXPECT_FALSE(draw_flies(image, {}, street_camera()).empty());
    EXPECT_FALSE(draw_flies(image, three_flies(), street_camera()).empty());
    EXPECT_FALSE(draw_concentrating(image, {}).empty());
    EXPECT_FALSE(draw_fitness_comparison(image, street_camera(), std::vector<TitledFlies>(2)).empty());
  }
  EXPECT_FALSE(draw_fitness_comparison({}, street_camera(), {}).empty());
  EXPECT_FALSE(draw_top_view({}, {}, {}, {}).empty());
  EXPECT_FALSE(draw_histogram({}).empty());
  EXPECT_FALSE(draw_histograms({}).empty());
}

}  // namespace
}  // namespace flies
