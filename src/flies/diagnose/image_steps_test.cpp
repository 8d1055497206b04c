#include "flies/diagnose/image_steps.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "flies/core/mat_view.hpp"
#include "flies/diagnose/textured_pair.hpp"

namespace flies {
namespace {

cv::Mat image_of(GrayImage& image) { return {image.height_px, image.width_px, CV_8UC1, image.pixels.data()}; }

/// Every other row is what was seen `moved_px` columns farther on.
cv::Mat interlaced(const cv::Mat& image, int moved_px) {
  cv::Mat woven = image.clone();
  for (int v = 1; v < image.rows; v += 2)
    image.row(v).colRange(moved_px, image.cols).copyTo(woven.row(v).colRange(0, image.cols - moved_px));
  return woven;
}

TEST(MeasureSteps, AnImageOfOneMomentIsNotCombed) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  EXPECT_EQ(measure_steps(pair.left.view()).combed_share, 0.0);
  EXPECT_FALSE(measure_steps(pair.left.view()).is_blurred());
}

TEST(MeasureSteps, RowsOfTwoMomentsAreCombedWhereThingsMove) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  const cv::Mat image = image_of(pair.left), woven = interlaced(image, 6);
  EXPECT_GT(measure_steps(view_of(woven)).combed_share, 0.95);
  cv::Mat part = image.clone();
  woven.colRange(0, 160).copyTo(part.colRange(0, 160));
  EXPECT_NEAR(measure_steps(view_of(part)).combed_share, 0.25, 0.05);
  EXPECT_TRUE(measure_steps(view_of(part)).is_combed());
}

TEST(MeasureSteps, NeitherAMosaicNorNoiseIsCombed) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  cv::Mat mosaic = image_of(pair.left) / 2;
  for (int v = 0; v < mosaic.rows; ++v)
    for (int u = 0; u < mosaic.cols; ++u)
      if (u % 2 == v % 2) mosaic.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(mosaic.at<std::uint8_t>(v, u) + 90);
  EXPECT_FALSE(measure_steps(view_of(mosaic)).is_combed());
  cv::Mat noise(240, 640, CV_8U);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_FALSE(measure_steps(view_of(noise)).is_combed());
}

TEST(MeasureSteps, BlurLeavesNothingSharp) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  cv::Mat blurred;
  cv::GaussianBlur(image_of(pair.left), blurred, {0, 0}, 3.0);
  EXPECT_TRUE(measure_steps(view_of(blurred)).is_blurred());
}

TEST(MedianSteps, BearsAnOddImage) {
  const ImageSteps good{0.0, 0.45}, odd{0.9, 0.26};
  EXPECT_FALSE(median_steps({good, odd, good}).is_combed());
  EXPECT_FALSE(median_steps({good, odd, good}).is_blurred());
  EXPECT_FALSE(median_steps({}).is_blurred());
}

}  // namespace
}  // namespace flies
