#include "flies/classify/hog.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include "flies/classify/named_models.hpp"
#include "flies/classify/people_model.hpp"
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

ImageBox window(double u_px, double v_px, double width_px, double height_px) {
  return {u_px, v_px, width_px, height_px};
}

double score_of(const cv::Mat& image, const ImageBox& box, const PeopleModel& model = opencv_48x96()) {
  std::vector<float> features(feature_count(model.hog));
  window_features(view_of(image), box, model.hog, features);
  return linear_score(model.linear, features);
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

TEST(WindowFeatures, EqualsOpencvsDetectorOnTheSameWindow) {
  const cv::Mat image = noise_image(160, 200);
  const auto weights = cv::HOGDescriptor::getDaimlerPeopleDetector();
  for (const bool gamma : {true, false}) {
    cv::HOGDescriptor hog({48, 96}, {16, 16}, {8, 8}, {8, 8}, 9);
    hog.gammaCorrection = gamma;
    PeopleModel model = opencv_48x96();
    model.hog.gamma = gamma;
    for (const cv::Point corner : {cv::Point{1, 1}, cv::Point{40, 33}, cv::Point{111, 103}})
      EXPECT_NEAR(score_of(image, window(corner.x, corner.y, 48, 96), model),
                  detector_score(image, hog, weights, corner), kScoreTolerance);
  }
}

/// Ours sums in another order, takes no table for the square root, and has a polynomial of its own for the angle.
constexpr float kFeatureTolerance = 1e-5F;

TEST(HogFeatures, AreThoseOfOpencv) {
  const cv::Mat image = noise_image(50, 98);
  for (const bool gamma : {true, false}) {
    HogGeometry geometry;
    geometry.gamma = gamma;
    std::vector<float> ours(feature_count(geometry)), theirs;
    hog_features(view_of(image), geometry, ours);
    cv::HOGDescriptor hog({48, 96}, {16, 16}, {8, 8}, {8, 8}, 9);
    hog.gammaCorrection = gamma;
    hog.compute(image, theirs, {}, {}, {{kHogMargin_px, kHogMargin_px}});
    ASSERT_EQ(ours.size(), 1980U);
    ASSERT_EQ(theirs.size(), ours.size());
    for (std::size_t i = 0; i < ours.size(); ++i) ASSERT_NEAR(ours[i], theirs[i], kFeatureTolerance) << i;
  }
}

TEST(WindowFeatures, AreTheSameOnEveryTarget) {
  const cv::Mat image = noise_image(90, 170);
  HogGeometry many_bins;
  many_bins.bins = 18;
  many_bins.cell_px = 4;
  for (const HogGeometry& geometry : {HogGeometry{}, many_bins}) {
    // Enlarged, little and much reduced; the last ends with the image, behind which nothing may be read.
    for (const ImageBox& box :
         {window(3.3, 2.1, 40, 80), window(20, 30, 60, 120), window(-10, -5, 100, 200), window(10, 10, 80, 160)}) {
      std::vector<float> expected(feature_count(geometry)), found(expected.size());
      window_features(view_of(image), box, geometry, expected);
      for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        window_features(view_of(image), box, geometry, found);
        EXPECT_EQ(found, expected) << hwy::TargetName(target);
      }
      hwy::SetSupportedTargetsForTest(0);
    }
  }
}

TEST(HogFeatures, AreNothingOnAUniformWindow) {
  const cv::Mat image(98, 50, CV_8UC1, cv::Scalar(77));
  std::vector<float> features(feature_count({}), 1.0F);
  hog_features(view_of(image), {}, features);
  EXPECT_EQ(features, std::vector<float>(features.size(), 0.0F));
}

TEST(WindowFeatures, ServesOtherWindowSizes) {
  const cv::Mat image = noise_image(160, 200);
  EXPECT_NEAR(score_of(image, window(30, 40, 64, 128), people_model("opencv-64x128")),
              detector_score(image, cv::HOGDescriptor(), cv::HOGDescriptor::getDefaultPeopleDetector(), {30, 40}),
              kScoreTolerance);
}

TEST(WindowFeatures, RepeatsTheBorderWhereAWindowLeavesTheImage) {
  const cv::Mat image = noise_image(120, 150);
  constexpr int kBorder_px = 80;
  cv::Mat wider;
  cv::copyMakeBorder(image, wider, kBorder_px, kBorder_px, kBorder_px, kBorder_px, cv::BORDER_REPLICATE);
  for (const cv::Point corner : {cv::Point{-20, -30}, cv::Point{90, 10}, cv::Point{10, 100}, cv::Point{-47, 60}})
    EXPECT_DOUBLE_EQ(score_of(image, window(corner.x, corner.y, 48, 96)),
                     score_of(wider, window(corner.x + kBorder_px, corner.y + kBorder_px, 48, 96)));
}

TEST(WindowFeatures, AgreesAcrossScales) {
  const cv::Mat image = noise_image(120, 160);
  cv::Mat twice;
  cv::resize(image, twice, {}, 2.0, 2.0, cv::INTER_LINEAR);
  // Resampling twice softens the picture a little; unrelated windows of this picture differ by 1 and more.
  constexpr double kResamplingTolerance = 0.3;
  EXPECT_NEAR(score_of(twice, window(60, 60, 96, 192)), score_of(image, window(30, 30, 48, 96)), kResamplingTolerance);
}

TEST(WindowFeatures, SurviveAnImageOfOnePixel) {
  const cv::Mat image(1, 1, CV_8UC1, cv::Scalar(99));
  EXPECT_TRUE(std::isfinite(score_of(image, window(-2, -4, 4, 8))));
}

TEST(IsWorthALook, RefusesWindowsWithNothingInThem) {
  const cv::Mat image = noise_image(120, 150);
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const ImageBox& box :
       {window(0, 0, 0, 0), window(0, 0, -48, -96), window(nan, 0, 48, 96), window(0, 0, infinity, 96),
        window(120, 0, 48, 96), window(0, -96, 48, 96), window(0, 0, 5e8, 1e9)})
    EXPECT_FALSE(is_worth_a_look(box, view_of(image)));
  EXPECT_TRUE(is_worth_a_look(window(119, 149, 48, 96), view_of(image)));
}

TEST(FeatureCount, IsThatOfThePaper) {
  EXPECT_EQ(feature_count({}), 1980U);
  EXPECT_EQ(feature_count({.window_width_px = 64, .window_height_px = 128}), 3780U);
}

TEST(CheckHogGeometry, NamesTheField) {
  const auto complaint = [](const HogGeometry& geometry) -> std::string {
    try {
      check_hog_geometry(geometry, "here");
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(complaint({}), "");
  EXPECT_EQ(complaint({.window_width_px = 47}),
            "here: hog.window_width_px: found 47, expected half of window_height_px, which is 96");
  EXPECT_NE(complaint({.window_height_px = 2000}).find("hog.window_height_px"), std::string::npos);
  EXPECT_NE(complaint({.block_px = 49}).find("hog.block_px"), std::string::npos);
  EXPECT_NE(complaint({.stride_px = 5}).find("hog.stride_px"), std::string::npos);
  EXPECT_NE(complaint({.cell_px = 0}).find("hog.cell_px"), std::string::npos);
  EXPECT_NE(complaint({.bins = 1}).find("hog.bins"), std::string::npos);
}

}  // namespace
}  // namespace flies
