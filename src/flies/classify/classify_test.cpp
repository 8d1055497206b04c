#include "flies/classify/classify.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

/// Both sum some 2000 products of single-precision features, in another order.
constexpr double kScoreTolerance = 1e-4;

cv::Mat noise_image(int width_px, int height_px) {
  cv::Mat image(height_px, width_px, CV_8UC1);
  FlyRandom random(7, 0, 0, 0);
  for (int v = 0; v < height_px; ++v)
    for (int u = 0; u < width_px; ++u) image.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(random.below(256));
  cv::GaussianBlur(image, image, {0, 0}, 2.0);
  return image;
}

GrayView view_of(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

Roi window(double u_px, double v_px, double width_px, double height_px) {
  Roi roi;
  roi.window = {u_px, v_px, width_px, height_px};
  return roi;
}

double score_of(const cv::Mat& image, const Roi& roi, const PeopleModel& model = builtin_people_model()) {
  return score_rois(view_of(image), std::vector{roi}, model).front();
}

/// The score that OpenCV's own sliding detector gives the window at this corner.
double detector_score(const cv::Mat& image, cv::HOGDescriptor hog, const std::vector<float>& weights,
                      cv::Point corner) {
  hog.setSVMDetector(weights);
  std::vector<cv::Point> hits;
  std::vector<double> scores;
  constexpr double kAcceptAll = -1e6;
  hog.detect(image, hits, scores, kAcceptAll, {1, 1}, {}, {corner});
  return scores.at(0);
}

TEST(ScoreRois, IsEmptyWithoutRois) {
  const cv::Mat image = noise_image(64, 64);
  EXPECT_TRUE(score_rois(view_of(image), {}, builtin_people_model()).empty());
}

TEST(ScoreRois, EqualsOpencvsDetectorOnTheSameWindow) {
  const cv::Mat image = noise_image(160, 200);
  const auto weights = cv::HOGDescriptor::getDaimlerPeopleDetector();
  for (const bool gamma : {true, false}) {
    cv::HOGDescriptor hog({48, 96}, {16, 16}, {8, 8}, {8, 8}, 9);
    hog.gammaCorrection = gamma;
    PeopleModel model = builtin_people_model();
    model.gamma = gamma;
    for (const cv::Point corner : {cv::Point{1, 1}, cv::Point{40, 33}, cv::Point{111, 103}})
      EXPECT_NEAR(score_of(image, window(corner.x, corner.y, 48, 96), model),
                  detector_score(image, hog, weights, corner), kScoreTolerance);
  }
}

TEST(ScoreRois, ServesOtherWindowSizes) {
  const cv::Mat image = noise_image(160, 200);
  EXPECT_NEAR(score_of(image, window(30, 40, 64, 128), people_model("opencv-64x128")),
              detector_score(image, cv::HOGDescriptor(), cv::HOGDescriptor::getDefaultPeopleDetector(), {30, 40}),
              kScoreTolerance);
}

TEST(ScoreRois, RepeatsTheBorderWhereAWindowLeavesTheImage) {
  const cv::Mat image = noise_image(120, 150);
  constexpr int kBorder_px = 80;
  cv::Mat wider;
  cv::copyMakeBorder(image, wider, kBorder_px, kBorder_px, kBorder_px, kBorder_px, cv::BORDER_REPLICATE);
  for (const cv::Point corner : {cv::Point{-20, -30}, cv::Point{90, 10}, cv::Point{10, 100}, cv::Point{-47, 60}})
    EXPECT_DOUBLE_EQ(score_of(image, window(corner.x, corner.y, 48, 96)),
                     score_of(wider, window(corner.x + kBorder_px, corner.y + kBorder_px, 48, 96)));
}

TEST(ScoreRois, AgreesAcrossScales) {
  const cv::Mat image = noise_image(120, 160);
  cv::Mat twice;
  cv::resize(image, twice, {}, 2.0, 2.0, cv::INTER_LINEAR);
  // Resampling twice softens the picture a little; unrelated windows of this picture differ by 1 and more.
  constexpr double kResamplingTolerance = 0.3;
  EXPECT_NEAR(score_of(twice, window(60, 60, 96, 192)), score_of(image, window(30, 30, 48, 96)), kResamplingTolerance);
}

TEST(ScoreRois, RefusesWindowsWithNothingInThem) {
  const cv::Mat image = noise_image(120, 150);
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const Roi& roi : {window(0, 0, 0, 0), window(0, 0, -48, -96), window(nan, 0, 48, 96), window(0, 0, infinity, 96),
                         window(120, 0, 48, 96), window(0, -96, 48, 96), window(0, 0, 5e8, 1e9)})
    EXPECT_EQ(score_of(image, roi), -infinity);
}

TEST(ScoreRois, SurvivesAnImageOfOnePixel) {
  const cv::Mat image(1, 1, CV_8UC1, cv::Scalar(99));
  EXPECT_TRUE(std::isfinite(score_of(image, window(-2, -4, 4, 8))));
}

TEST(ScoreRois, DoesNotDependOnTheNumberOfThreads) {
  const cv::Mat image = noise_image(300, 200);
  std::vector<Roi> rois;
  for (int i = 0; i < 60; ++i) rois.push_back(window(4.3 * i, i, 30 + i, 60 + 2 * i));
  const auto parallel = score_rois(view_of(image), rois, builtin_people_model());
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(score_rois(view_of(image), rois, builtin_people_model()), parallel);
}

TEST(ScoreRois, RejectsAModelWithMissingWeights) {
  const cv::Mat image = noise_image(64, 64);
  PeopleModel model = builtin_people_model();
  model.weights.pop_back();
  EXPECT_THROW(score_of(image, window(0, 0, 48, 96), model), InputError);
}

/// A person of 1.75 m as a camera of 720 px at 1.65 m sees them.
Roi person(double x_m, double y_m, double height_m = 1.75) {
  Roi roi;
  const double tall_px = 720.0 * height_m / x_m;
  roi.person = {610.0 - 720.0 * y_m / x_m - tall_px / 4.0, 173.0 + 720.0 * 1.65 / x_m - tall_px, tall_px / 2.0,
                tall_px};
  roi.x_m = x_m;
  roi.y_m = y_m;
  roi.height_m = height_m;
  return roi;
}

std::vector<Pedestrian> suppress(const std::vector<Roi>& rois, const std::vector<double>& scores,
                                 const ClassifyOptions& options = {}) {
  PeopleModel model;
  model.threshold = 0.5;
  return suppress_in_metres(rois, scores, model, options);
}

TEST(SuppressInMetres, IsEmptyWithoutRois) { EXPECT_TRUE(suppress({}, {}).empty()); }

TEST(SuppressInMetres, MakesOnePersonOfManyBoxes) {
  const auto people =
      suppress({person(10, 0), person(10, 0.2), person(10.4, -0.2), person(9.5, 0.1), person(10, 0, 1.2)},
               {1.0, 2.5, 0.9, 1.2, 0.7});
  ASSERT_EQ(people.size(), 1U);
  EXPECT_DOUBLE_EQ(people[0].x_m, 10.0);
  EXPECT_DOUBLE_EQ(people[0].y_m, 0.2);
  EXPECT_DOUBLE_EQ(people[0].range_m, std::hypot(10.0, 0.2));
  EXPECT_DOUBLE_EQ(people[0].height_m, 1.75);
  EXPECT_DOUBLE_EQ(people[0].score, 2.5);
  EXPECT_DOUBLE_EQ(people[0].box.height_px, 126.0);
}

TEST(SuppressInMetres, KeepsTwoPeopleSideBySide) {
  EXPECT_EQ(suppress({person(10, 0), person(10, 1.0)}, {1.0, 2.0}).size(), 2U);
  EXPECT_EQ(suppress({person(10, 0), person(10, 0.5)}, {1.0, 2.0}).size(), 2U);
}

TEST(SuppressInMetres, KeepsPeopleAtTwoRangesWhoSeeEachOthersEdge) {
  EXPECT_EQ(suppress({person(6, 0), person(12, 1.0)}, {1.0, 2.0}).size(), 2U);
}

TEST(SuppressInMetres, SeesNobodyThroughAnother) {
  const auto people = suppress({person(6, 0), person(12, 0.2)}, {2.0, 1.0});
  ASSERT_EQ(people.size(), 1U);
  EXPECT_DOUBLE_EQ(people[0].x_m, 6.0);
}

TEST(SuppressInMetres, MakesOnePersonOfLikeBoxesAtTwoRanges) {
  const auto people = suppress({person(9, 0, 1.5), person(11, 0, 1.85)}, {1.0, 1.1});
  ASSERT_EQ(people.size(), 1U);
  EXPECT_DOUBLE_EQ(people[0].x_m, 11.0);
}

TEST(SuppressInMetres, ReportsNearestFirst) {
  const auto people = suppress({person(20, 0), person(5, -2), person(10, 3)}, {3.0, 1.0, 2.0});
  ASSERT_EQ(people.size(), 3U);
  EXPECT_LT(people[0].range_m, people[1].range_m);
  EXPECT_LT(people[1].range_m, people[2].range_m);
}

TEST(SuppressInMetres, ComparesWithTheThresholdAndItsOffset) {
  EXPECT_EQ(suppress({person(10, 0)}, {0.5}).size(), 0U) << "the score must exceed the threshold";
  EXPECT_EQ(suppress({person(10, 0)}, {0.6}).size(), 1U);
  ClassifyOptions options;
  options.threshold_offset = 0.2;
  EXPECT_EQ(suppress({person(10, 0)}, {0.6}, options).size(), 0U);
}

TEST(SuppressInMetres, IgnoresRefusedWindows) {
  EXPECT_TRUE(
      suppress({person(10, 0), person(10, 0)}, {-std::numeric_limits<double>::infinity(), std::nan("")}).empty());
}

}  // namespace
}  // namespace flies
