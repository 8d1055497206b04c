#include "flies/train/weights_picture.hpp"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

namespace flies {
namespace {

TEST(DrawWeights, DrawsPositiveOnesLeftAndNegativeOnesRight) {
  const HogGeometry hog;
  std::vector<float> weights(feature_count(hog), 0.0F);
  weights[4] = 1.0F;  // first block, first cell, 80 to 100 degrees: a gradient along v, a level edge
  const cv::Mat picture = draw_weights(weights, hog);
  const int half = picture.cols / 2;
  EXPECT_GT(cv::norm(picture(cv::Rect(0, 0, 32, 32))), 0.0);
  EXPECT_EQ(cv::norm(picture(cv::Rect(half + 8, 0, half - 8, picture.rows))), 0.0);
  EXPECT_GT(picture.at<cv::Vec3b>(16, 4)[0], 0) << "level";
  EXPECT_EQ(picture.at<cv::Vec3b>(4, 16)[0], 0) << "not upright";

  weights[4] = -1.0F;
  const cv::Mat against = draw_weights(weights, hog);
  EXPECT_EQ(cv::norm(against(cv::Rect(0, 0, half - 8, against.rows))), 0.0);
  EXPECT_GT(cv::norm(against(cv::Rect(half + 8, 0, half - 8, against.rows))), 0.0);
}

}  // namespace
}  // namespace flies
