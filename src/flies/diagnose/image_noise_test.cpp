#include "flies/diagnose/image_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "flies/core/mat_view.hpp"
#include "flies/io/images.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

/// A slope of grey levels with an edge in each cell of the grid, and noise.
cv::Mat scene(double noise_gray, double gain = 1.0) {
  cv::Mat levels(240, 640, CV_32F), noise(levels.size(), CV_32F), image;
  for (int v = 0; v < levels.rows; ++v)
    for (int u = 0; u < levels.cols; ++u)
      levels.at<float>(v, u) = static_cast<float>(gain * (60.0 + 0.1 * u + (u % 32 < 16 ? 60.0 : 0.0)));
  cv::RNG(7).fill(noise, cv::RNG::NORMAL, 0.0, noise_gray);
  cv::add(levels, noise, noise);
  noise.convertTo(image, CV_8U);
  return image;
}

TEST(MeasureNoise, FindsTheDeviationOfThePixels) {
  for (const double noise_gray : {2.0, 5.0, 12.0})
    EXPECT_NEAR(measure_noise(view_of(scene(noise_gray))).noise_gray, noise_gray, 0.15 * noise_gray);
  EXPECT_LT(measure_noise(view_of(scene(0.0))).noise_gray, 0.5);
}

TEST(MeasureNoise, SetsItAgainstTheContrastOfTheScene) {
  EXPECT_GT(measure_noise(view_of(scene(2.0))).contrast_to_noise(), 8.0);
  EXPECT_LT(measure_noise(view_of(scene(4.0, 0.15))).contrast_to_noise(), 3.0);
  EXPECT_TRUE(std::isinf(measure_noise(view_of(cv::Mat(48, 64, CV_8U, cv::Scalar(9)))).contrast_to_noise()));
}

TEST(MeasureNoise, WhatIsCutOffAtWhiteDoesNotHideIt) {
  cv::Mat half_white = scene(6.0);
  half_white.rowRange(0, 120).setTo(255);
  EXPECT_NEAR(measure_noise(view_of(half_white)).noise_gray, 6.0, 1.0);
}

TEST(MeasureNoise, WhatIsMaskedOutSaysNothing) {
  cv::Mat right_part = scene(2.0);
  right_part.colRange(0, 350).setTo(0);
  const ImageNoise whole = measure_noise(view_of(scene(2.0))), masked = measure_noise(view_of(right_part));
  EXPECT_NEAR(masked.noise_gray, whole.noise_gray, 0.2);
  EXPECT_NEAR(masked.contrast_gray, whole.contrast_gray, 0.1 * whole.contrast_gray);
}

TEST(MeasureNoise, RealStreetsHaveLittle) {
  const auto streets = testing::find_data("kitti_stereo2012/image_0");
  if (!streets) GTEST_SKIP() << testing::absence("kitti_stereo2012");
  int images = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*streets)) {
    EXPECT_GT(measure_noise(load_gray_image(entry.path().string()).view()).contrast_to_noise(), kLeastContrastToNoise)
        << entry.path();
    ++images;
  }
  EXPECT_GT(images, 10);
}

TEST(MedianNoise, IsTheMiddleOne) {
  EXPECT_EQ(median_noise({{1.0, 10.0}, {4.0, 8.0}, {1.0, 30.0}}).noise_gray, 1.0);
  EXPECT_EQ(median_noise({{1.0, 10.0}, {4.0, 8.0}, {1.0, 30.0}}).contrast_gray, 10.0);
  EXPECT_EQ(median_noise({}).noise_gray, 0.0);
}

}  // namespace
}  // namespace flies
