#include "flies/diagnose/image_borders.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "flies/core/mat_view.hpp"
#include "flies/diagnose/textured_pair.hpp"

namespace flies {
namespace {

cv::Mat padded(GrayImage& image, int top, int bottom, int left, int right, int level) {
  cv::Mat result;
  cv::copyMakeBorder(cv::Mat(image.height_px, image.width_px, CV_8UC1, image.pixels.data()), result, top, bottom, left,
                     right, cv::BORDER_CONSTANT, level);
  return result;
}

TEST(FindBorders, FindsWhatPaddingAdded) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  EXPECT_FALSE(find_borders(pair.view()).any());
  const cv::Mat left = padded(pair.left, 2, 9, 3, 6, 114), right = padded(pair.right, 2, 9, 3, 6, 114);
  const auto borders = find_borders({view_of(left), view_of(right)});
  EXPECT_EQ(borders.top_px, 2);
  EXPECT_EQ(borders.bottom_px, 9);
  EXPECT_EQ(borders.left_px, 3);
  EXPECT_EQ(borders.right_px, 6);
}

TEST(FindBorders, WhatOneImageAloneLeavesEmptyIsNone) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  const cv::Mat left = padded(pair.left, 0, 9, 0, 0, 0), right = padded(pair.right, 9, 0, 0, 0, 0);
  EXPECT_FALSE(find_borders({view_of(left), view_of(right)}).any());
}

TEST(FindBorders, APairOfOneLevelHasNone) {
  const cv::Mat plain(48, 64, CV_8U, cv::Scalar(90));
  EXPECT_FALSE(find_borders({view_of(plain), view_of(plain)}).any());
}

}  // namespace
}  // namespace flies
