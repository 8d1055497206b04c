#include "flies/io/packed_yuv.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flies/io/gray_levels.hpp"

namespace flies::detail {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kWidth_px = 160, kHeight_px = 96;

/// Smooth noise of this spread about this level.
cv::Mat scene(double middle, double spread, int seed, cv::Size size = {kWidth_px, kHeight_px}) {
  cv::RNG random(static_cast<std::uint64_t>(seed));
  cv::Mat noise(size, CV_32F), smooth, levels;
  random.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  cv::GaussianBlur(noise, smooth, {}, 3.0);
  cv::Scalar deviation;
  cv::meanStdDev(smooth, cv::noArray(), deviation);
  smooth.convertTo(levels, CV_8U, spread / deviation[0], middle);
  return levels;
}

cv::Mat colour(int seed) { return scene(122.0, 12.0, seed); }

cv::Mat packed(const cv::Mat& luma, const cv::Mat& color, bool is_luma_first) {
  const std::array both = is_luma_first ? std::array{luma, color} : std::array{color, luma};
  cv::Mat columns;
  cv::merge(both.data(), 2, columns);
  return columns.reshape(1);
}

cv::Mat in_planes(const cv::Mat& luma) {
  cv::Mat all;
  cv::vconcat(luma, scene(122.0, 12.0, 9, {kWidth_px, kHeight_px / 2}), all);
  return all;
}

void expect_equal(const cv::Mat& found, const cv::Mat& expected) {
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0.0);
}

TEST(RecogniseYuv, FindsBrightnessBesideColour) {
  const cv::Mat luma = scene(90.0, 40.0, 1);
  for (const auto layout : {YuvLayout::yuyv, YuvLayout::uyvy}) {
    const cv::Mat image = packed(luma, colour(2), layout == YuvLayout::yuyv);
    ASSERT_EQ(recognise_yuv(image), layout);
    expect_equal(luma_of(image, layout), luma);
    const cv::Mat grey = packed(luma, cv::Mat(luma.size(), CV_8U, cv::Scalar(128)), layout == YuvLayout::yuyv);
    EXPECT_EQ(recognise_yuv(grey), layout);
  }
  ASSERT_EQ(recognise_yuv(in_planes(luma)), YuvLayout::planes);
  expect_equal(luma_of(in_planes(luma), YuvLayout::planes), luma);
}

TEST(RecogniseYuv, PassesOverOtherImages) {
  EXPECT_FALSE(recognise_yuv(scene(120.0, 40.0, 1)));
  EXPECT_FALSE(recognise_yuv(scene(128.0, 4.0, 1)));
  cv::Mat noise(kHeight_px, kWidth_px, CV_8U), wide;
  cv::randu(noise, 0, 256);
  EXPECT_FALSE(recognise_yuv(noise));
  EXPECT_FALSE(recognise_yuv(packed(scene(90.0, 40.0, 1), scene(90.0, 40.0, 2), true)));  // two cameras by columns
  wide = scene(90.0, 40.0, 1);
  wide.convertTo(wide, CV_16U, 256.0);
  EXPECT_FALSE(recognise_yuv(wide));
}

TEST(PairOfLevels, LeavesOutColourThatWasSavedAsGrey) {
  const cv::Mat left = scene(90.0, 40.0, 1), right = scene(90.0, 40.0, 3);
  const auto pair = pair_of_levels(packed(left, colour(2), true), packed(right, colour(4), true));
  EXPECT_EQ(pair.left.width_px, kWidth_px);
  EXPECT_EQ(pair.right.height_px, kHeight_px);
  EXPECT_THAT(pair.notes, Contains(HasSubstr("YUYV")));
  EXPECT_EQ(pair.left.pixels[1], left.at<std::uint8_t>(0, 1));
  const auto unlike = pair_of_levels(packed(left, colour(2), true), scene(90.0, 40.0, 3, {2 * kWidth_px, kHeight_px}));
  EXPECT_EQ(unlike.left.width_px, 2 * kWidth_px);
}

}  // namespace
}  // namespace flies::detail
