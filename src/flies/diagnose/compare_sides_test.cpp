#include "flies/diagnose/compare_sides.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <string>

#include "flies/diagnose/textured_pair.hpp"

namespace flies {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

cv::Mat mat_of(GrayImage& image) { return {image.height_px, image.width_px, CV_8UC1, image.pixels.data()}; }

TEST(CompareSides, FindsNothingInAGoodPair) {
  const auto difference = compare_sides(textured_pair(8.0, 0.0, 0.0).view());
  EXPECT_EQ(difference.left_blind_share, 0.0);
  EXPECT_EQ(difference.right_blind_share, 0.0);
  EXPECT_NEAR(difference.sharpness, 1.0, 0.05);
  EXPECT_NEAR(difference.contrast, 1.0, 0.05);
  EXPECT_THAT(complaints(difference), IsEmpty());
}

TEST(CompareSides, TellsOnWhichSideAPartIsMissing) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  mat_of(pair.right).colRange(320, 640).setTo(0);
  EXPECT_NEAR(compare_sides(pair.view()).right_blind_share, 0.25, 0.01);  // a quarter may have its partners in the rest
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("the right image shows nothing in 25 %")));
  std::swap(pair.left, pair.right);
  EXPECT_THAT(complaints(compare_sides(pair.view())), testing::Contains(HasSubstr("the left image shows nothing in")));
}

TEST(CompareSides, TellsWhichImageIsBlurred) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  cv::GaussianBlur(mat_of(pair.left), mat_of(pair.left), {0, 0}, 5.0);
  cv::normalize(mat_of(pair.left), mat_of(pair.left), 20, 235, cv::NORM_MINMAX);
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("the left image is 0.")));
}

TEST(CompareSides, TellsBlurThatCostsContrastFromAnotherExposure) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  cv::GaussianBlur(mat_of(pair.right), mat_of(pair.right), {0, 0}, 3.0);
  EXPECT_LT(compare_sides(pair.view()).contrast, 0.7);
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("times as sharp")));
}

TEST(CompareSides, TellsAnotherExposure) {
  for (const double gain : {0.25, 0.3, 0.5, 0.7, 2.0}) {
    GrayPair pair = textured_pair(8.0, 0.0, 0.0);
    mat_of(pair.right) *= gain;
    EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("are exposure and gain of both cameras")))
        << gain;
  }
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  mat_of(pair.left) *= 0.5;
  EXPECT_THAT(
      complaints(compare_sides(pair.view())),
      ElementsAre(HasSubstr("the right image is 2 times as bright as the left one and has 2 times its contrast")));
  pair = textured_pair(8.0, 0.0, 0.0);
  mat_of(pair.right) *= 0.85;
  EXPECT_THAT(complaints(compare_sides(pair.view())), IsEmpty());
}

TEST(CompareSides, AFainterImageHasDirtOnlyWhereThereIsSome) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  cv::Mat right = mat_of(pair.right);
  // A calm part of the scene, which a quarter of the exposure makes calmer still.
  cv::Mat calm = mat_of(pair.left)(cv::Rect(200, 60, 160, 120)), calm_right = right(cv::Rect(192, 60, 160, 120));
  calm = calm * 0.1 + 90;
  calm_right = calm_right * 0.1 + 90;
  right *= 0.25;
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("exposure")));
  cv::circle(right, {480, 120}, 40, 25, cv::FILLED);
  EXPECT_THAT(complaints(compare_sides(pair.view())),
              ElementsAre(HasSubstr("% of the right image shows nothing"), HasSubstr("exposure")));
}

TEST(CompareSides, TellsNoiseOfOneSideFromABlurredOther) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  cv::Mat right = mat_of(pair.right), noise(right.size(), CV_16S);
  cv::RNG(7).fill(noise, cv::RNG::NORMAL, 0.0, 15.0);
  cv::add(right, noise, right, cv::noArray(), CV_8U);
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("the right image is noisy")));
  std::swap(pair.left, pair.right);
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("the left image is noisy")));
}

TEST(CompareSides, TellsOnWhichLensThereIsDirt) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  cv::Mat right = mat_of(pair.right);
  cv::circle(right, {300, 120}, 40, 25, cv::FILLED);
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("% of the right image shows nothing")));
  std::swap(pair.left, pair.right);
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("% of the left image shows nothing")));
}

TEST(CompareSides, TellsLostRowsButNotThoseThatRectifyingLeavesEmpty) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  mat_of(pair.left).rowRange(0, 6).setTo(0);
  EXPECT_THAT(complaints(compare_sides(pair.view())), IsEmpty());
  mat_of(pair.left).rowRange(100, 106).setTo(0);
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("of the rows of the left image")));
}

TEST(CompareSides, TellsColumnsThatAreStuckAndNotThatTheOtherImageIsBlurred) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  for (int u = 3; u < 640; u += 8) mat_of(pair.right).col(u).setTo(255);
  EXPECT_THAT(complaints(compare_sides(pair.view())),
              ElementsAre(HasSubstr("12 % of the columns of the right image have one grey level throughout")));
  std::swap(pair.left, pair.right);
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("of the columns of the left image")));
}

TEST(CompareSides, BlackThatReachesInFromTheBorderIsNoDirt) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  const auto wedge = [](GrayImage& image, int from_u, int to_u) {
    const std::vector<cv::Point> corners{{from_u, 0}, {to_u, 0}, {from_u, 200}};
    cv::fillPoly(mat_of(image), std::vector<std::vector<cv::Point>>{corners}, 0);
  };
  wedge(pair.left, 0, 80);
  wedge(pair.right, 639, 559);
  EXPECT_THAT(complaints(compare_sides(pair.view())), IsEmpty());
  cv::circle(mat_of(pair.right), {300, 120}, 40, 0, cv::FILLED);  // dirt that is as black
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("% of the right image shows nothing")));
}

TEST(CompareSides, ACalmPartOfABlurredOrDarkImageIsNoDirt) {
  SideDifference blurred{.sharpness = 0.27, .right_blind_patch = 0.012};
  EXPECT_THAT(complaints(blurred), ElementsAre(HasSubstr("the right image is 0.27 times as sharp")));
  SideDifference dark{.brightness = 0.6, .right_blind_patch = 0.012};
  EXPECT_THAT(complaints(dark), ElementsAre(HasSubstr("exposure and gain")));
  blurred.right_blind_patch = 0.05;
  EXPECT_THAT(complaints(blurred), ElementsAre(HasSubstr("a patch of 5 % of the right image")));
  SideDifference other_side{.sharpness = 0.27, .left_blind_patch = 0.012};
  EXPECT_THAT(complaints(other_side), ElementsAre(HasSubstr("a patch of 1 % of the left image")));
}

TEST(CompareSides, TellsAPartThatIsBlurred) {
  GrayPair pair = textured_pair(8.0, 0.0, 0.0);
  cv::Mat part = mat_of(pair.right).colRange(213, 427), blurred;
  cv::GaussianBlur(part, blurred, {0, 0}, 8.0);
  cv::normalize(blurred, blurred, 20, 235, cv::NORM_MINMAX);
  blurred.copyTo(part);
  EXPECT_THAT(complaints(compare_sides(pair.view())), ElementsAre(HasSubstr("a part of the right image is 0.")));
}

TEST(MedianSideDifference, BearsAFewOddPairs) {
  const SideDifference odd{.left_blind_share = 0.5, .right_blind_share = 0.5, .sharpness = 3.0, .contrast = 0.1};
  EXPECT_THAT(complaints(median_side_difference({{}, odd, {}})), IsEmpty());
  EXPECT_THAT(complaints(median_side_difference({})), IsEmpty());
}

}  // namespace
}  // namespace flies
