#include "flies/classify/people_classifier.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "flies/classify/convolution.hpp"
#include "flies/classify/first_network.hpp"
#include "flies/classify/model_file.hpp"
#include "flies/classify/named_models.hpp"
#include "flies/classify/resample.hpp"
#include "flies/core/error.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

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

/// A second stage that likes windows as they like to be: near its one support vector.
PeopleModel two_stages(std::vector<float> favourite, double reject_below) {
  PeopleModel model = opencv_48x96();
  model.linear.reject_below = reject_below;
  KernelStage kernel;
  kernel.mean.assign(feature_count(model.hog), 0.0F);
  kernel.support_vectors = {1, feature_count(model.hog), std::move(favourite)};
  kernel.coefficients = {1.0F};
  model.kernel = kernel;
  return model;
}

std::vector<double> linear_scores(const cv::Mat& image, std::span<const ImageBox> boxes) {
  const PeopleModel model = opencv_48x96();
  std::vector<double> scores;
  for (const ImageBox& box : boxes) {
    std::vector<float> features(feature_count(model.hog));
    window_features(view_of(image), box, model.hog, features);
    scores.push_back(linear_score(model.linear, features));
  }
  return scores;
}

const std::vector<ImageBox> kBoxes{window(0, 0, 48, 96), window(100, 50, 48, 96), window(40, 100, 48, 96),
                                   window(60, 10, 60, 120), window(90, 30, 70, 140)};

TEST(ModelClassifier, AsksConvolutionsAboutWhatTheLinearMachineLetsThrough) {
  const cv::Mat image = noise_image(200, 240);
  auto scores = linear_scores(image, kBoxes);
  PeopleModel model = opencv_48x96();
  std::vector<double> sorted = scores;
  std::sort(sorted.begin(), sorted.end());
  model.linear.reject_below = 0.5 * (sorted[1] + sorted[2]);
  ConvolutionStage stage;
  stage.layers.push_back({2, {1, 9, {1, 0, -1, 2, 0, -2, 1, 0, -1}}, {0.0F}, 20.0});
  stage.last.assign(std::size_t{24} * 48, 0.001F);
  stage.bias = -2.0;
  stage.linear_weight = 0.3;
  model.convolution = stage;
  const auto probabilities = model_classifier(model)->classify(view_of(image), kBoxes);
  constexpr double kRounding = 1e-3;  // whole numbers of 16 bits
  for (std::size_t i = 0; i < kBoxes.size(); ++i) {
    const double score = convolution_score(stage, convolution_input(view_of(image), kBoxes[i]));
    EXPECT_NEAR(probabilities[i], person_probability(model, scores[i], score), kRounding) << i;
    EXPECT_EQ(probabilities[i] >= kRejectedProbability, scores[i] >= model.linear.reject_below) << i;
  }
}

TEST(ModelClassifier, LetsANetworkRejectInFrontOfTheLinearMachine) {
  const cv::Mat image = noise_image(200, 240);
  for (const bool is_alone : {true, false}) {
    PeopleModel model = is_alone ? opencv_48x96() : two_stages(std::vector<float>(1980, 0.05F), -10.0);
    const auto without = model_classifier(model);
    const auto all = without->classify(view_of(image), kBoxes), first = without->screen(view_of(image), kBoxes);

    FirstNetwork network;
    network.layers.push_back({2, {1, 9, {1, 0, -1, 2, 0, -2, 1, 0, -1}}, {}, 500.0});
    network.layers.push_back({2, {1, 9, {0, 0, 0, 0, 1, 0, 0, 0, 0}}, {}, 500.0});
    network.last.assign(std::size_t{4} * 9, 0.5F);
    network.bias = -3.0;
    std::vector<double> scores;
    for (const ImageBox& box : kBoxes) {
      const FloatImage levels = resample(view_of(image), box, kFirstNetworkWidth_px, kFirstNetworkHeight_px);
      scores.push_back(first_network_score(network, levels.values));
    }
    std::vector<double> sorted = scores;
    std::sort(sorted.begin(), sorted.end());
    network.reject_below = 0.5 * (sorted[1] + sorted[2]);
    model.first_network = network;

    const auto classifier = model_classifier(model);
    EXPECT_EQ(classifier->screen_threshold(), without->screen_threshold());
    const auto passed = classifier->classify(view_of(image), kBoxes),
               screened = classifier->screen(view_of(image), kBoxes);
    constexpr double kRounding = 1e-9;  // windows share sums in other sets
    for (std::size_t i = 0; i < kBoxes.size(); ++i) {
      if (scores[i] >= network.reject_below) {
        EXPECT_NEAR(passed[i], all[i], kRounding) << i;
        EXPECT_NEAR(screened[i], first[i], kRounding) << i;
        continue;
      }
      EXPECT_GT(passed[i], 0.0) << i;
      EXPECT_LE(passed[i], kRejectedProbability * kRejectedProbability) << i;
      EXPECT_LT(screened[i], classifier->screen_threshold()) << i;
    }
  }
}

TEST(ModelClassifier, IsEmptyWithoutWindows) {
  const cv::Mat image = noise_image(64, 64);
  EXPECT_TRUE(model_classifier(opencv_48x96())->classify(view_of(image), {}).empty());
}

TEST(ModelClassifier, CalibratesTheLinearScore) {
  const cv::Mat image = noise_image(200, 220);
  PeopleModel model = opencv_48x96();
  model.linear.calibration = {2.0, 0.5};
  const auto scores = linear_scores(image, kBoxes);
  const auto probabilities = model_classifier(model)->classify(view_of(image), kBoxes);
  for (std::size_t i = 0; i < kBoxes.size(); ++i)
    EXPECT_DOUBLE_EQ(probabilities[i], 1.0 / (1.0 + std::exp(-(2.0 * scores[i] + 0.5))));
}

TEST(ModelClassifier, PutsWhatTheFirstStageRejectsBelowAllElse) {
  const cv::Mat image = noise_image(200, 220);
  const auto scores = linear_scores(image, kBoxes);
  auto sorted = scores;
  std::sort(sorted.begin(), sorted.end());
  const double reject_below = (sorted[1] + sorted[2]) / 2.0;
  const auto classifier = model_classifier(two_stages(std::vector<float>(1980, 0.0F), reject_below));
  const auto probabilities = classifier->classify(view_of(image), kBoxes);
  const auto screened = classifier->screen(view_of(image), kBoxes);
  for (std::size_t i = 0; i < kBoxes.size(); ++i) {
    EXPECT_EQ(scores[i] < reject_below, screened[i] < classifier->screen_threshold());
    EXPECT_EQ(scores[i] < reject_below, probabilities[i] < kRejectedProbability);
    EXPECT_GT(probabilities[i], 0.0);
    EXPECT_LE(probabilities[i], 1.0);
  }
}

TEST(ModelClassifier, LetsTheSecondStageDecide) {
  const cv::Mat image = noise_image(200, 220);
  std::vector<float> features(1980);
  window_features(view_of(image), kBoxes[3], {}, features);
  const auto probabilities = model_classifier(two_stages(features, -1e6))->classify(view_of(image), kBoxes);
  EXPECT_EQ(std::max_element(probabilities.begin(), probabilities.end()) - probabilities.begin(), 3);
  constexpr double kDistanceTolerance = 1e-5;  // the same features, in other vector lengths
  EXPECT_NEAR(probabilities[3], kRejectedProbability + (1.0 - kRejectedProbability) / (1.0 + std::exp(-1.0)),
              kDistanceTolerance);
}

/// Blocks that windows share are computed from pixels whose places differ in the last digits of a double.
constexpr double kSharingTolerance = 1e-6;

TEST(ModelClassifier, GivesWindowsThatShareBlocksTheProbabilityTheyHaveAlone) {
  const cv::Mat image = noise_image(300, 260);
  const auto classifier = model_classifier(opencv_48x96());
  std::vector<ImageBox> raster;
  for (const double scale : {0.7, 1.6})
    for (const int column : {0, -2, 1, 3})
      for (const int row : {0, 1, -1})
        raster.push_back(window(90.3 + column * 8 * scale, 60.7 + row * 8 * scale, 48 * scale, 96 * scale));
  raster.insert(raster.begin() + 5, window(0, 0, 0, 0));
  raster.insert(raster.begin() + 3, window(33.3, 40.1, 48 * 0.7, 96 * 0.7));
  const auto together = classifier->classify(view_of(image), raster);
  for (std::size_t i = 0; i < raster.size(); ++i)
    EXPECT_NEAR(together[i], classifier->classify(view_of(image), std::vector{raster[i]}).front(), kSharingTolerance);
}

TEST(ModelClassifier, LooksInTurnsAsAtOnce) {
  const cv::Mat image = noise_image(200, 220);
  const auto classifier = model_classifier(two_stages(std::vector<float>(1980, 0.05F), -1e6));
  std::vector<ImageBox> boxes = kBoxes;
  boxes.push_back(window(0, 0, 0, 0));
  const auto screened = classifier->screen(view_of(image), boxes),
             classified = classifier->classify(view_of(image), boxes);
  const auto looks = classifier->look_at(view_of(image), boxes);
  const auto expect = [](const std::vector<double>& found, const std::vector<double>& of_all,
                         std::span<const std::size_t> some) {
    ASSERT_EQ(found.size(), some.size());
    for (std::size_t k = 0; k < some.size(); ++k) EXPECT_NEAR(found[k], of_all[some[k]], kSharingTolerance) << k;
  };
  const std::vector<std::size_t> first{3, 0}, second{1, 2, 5}, last{4, 3, 5, 1};  // of the last one was not screened
  expect(looks->screen(first), screened, first);
  expect(looks->screen(second), screened, second);
  expect(looks->classify(last), classified, last);
  EXPECT_TRUE(looks->classify({}).empty());
}

TEST(ModelClassifier, GivesWindowsWithNothingInThemNoChance) {
  const cv::Mat image = noise_image(120, 150);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<ImageBox> boxes{window(0, 0, 0, 0), window(nan, 0, 48, 96), window(120, 0, 48, 96)};
  EXPECT_EQ(model_classifier(opencv_48x96())->classify(view_of(image), boxes), (std::vector<double>(3, 0.0)));
}

TEST(ModelClassifier, DoesNotDependOnTheNumberOfThreads) {
  const cv::Mat image = noise_image(300, 200);
  std::vector<ImageBox> boxes;
  for (int i = 0; i < 60; ++i) boxes.push_back(window(4.3 * i, i, 30 + i, 60 + 2 * i));
  const auto classifier = model_classifier(opencv_48x96());
  const auto parallel = classifier->classify(view_of(image), boxes);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(classifier->classify(view_of(image), boxes), parallel);
}

TEST(DefaultPeopleClassifier, IsTheShippedModelWithBothStages) {
  const auto classifier = default_people_classifier();
  EXPECT_TRUE(classifier->looks_twice());
  EXPECT_EQ(classifier->name(), shipped_people_model().name);
  EXPECT_LT(classifier->screen_threshold(), classifier->threshold());
}

TEST(ModelClassifier, RefusesAModelWithMissingWeights) {
  PeopleModel model = opencv_48x96();
  model.linear.weights.pop_back();
  EXPECT_THROW(model_classifier(model), InputError);
}

}  // namespace
}  // namespace flies
