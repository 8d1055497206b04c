#include "flies/io/image_borders.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "flies/core/mat_view.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;

struct Pictures {
  cv::Mat left, right;

  RectifiedPair view() const { return {view_of(left), view_of(right)}; }
};

Pictures textured(int width_px = 320, int height_px = 120) {
  const auto texture = [&](std::uint64_t seed) {
    cv::Mat noise(height_px, width_px, CV_8U);
    cv::RNG random(seed);
    random.fill(noise, cv::RNG::UNIFORM, 0, 256);
    return noise;
  };
  return {texture(1), texture(2)};
}

struct Added {
  int top = 0, bottom = 0, left = 0, right = 0;
};

Pictures padded(const Pictures& pictures, const Added& by, int level = 114, int how = cv::BORDER_CONSTANT) {
  Pictures result;
  cv::copyMakeBorder(pictures.left, result.left, by.top, by.bottom, by.left, by.right, how, level);
  cv::copyMakeBorder(pictures.right, result.right, by.top, by.bottom, by.left, by.right, how, level);
  return result;
}

void expect_borders(const ImageBorders& borders, const Added& added) {
  EXPECT_EQ(borders.top_px, added.top);
  EXPECT_EQ(borders.bottom_px, added.bottom);
  EXPECT_EQ(borders.left_px, added.left);
  EXPECT_EQ(borders.right_px, added.right);
}

TEST(FindBorders, FindsWhatPaddingAdded) {
  constexpr Added kAdded{2, 9, 3, 6};
  EXPECT_FALSE(find_borders(textured().view()).any());
  expect_borders(find_borders(padded(textured(), kAdded).view()), kAdded);
  expect_borders(find_borders(padded(textured(), kAdded, 0, cv::BORDER_REPLICATE).view()), kAdded);
}

TEST(FindBorders, WhatOneImageAloneLeavesEmptyIsNone) {
  const auto left = padded(textured(), {0, 9, 0, 0}), right = padded(textured(), {9, 0, 0, 0});
  EXPECT_FALSE(find_borders({view_of(left.left), view_of(right.right)}).any());
}

TEST(FindBorders, APairOfOneLevelHasNone) {
  const cv::Mat plain(48, 64, CV_8U, cv::Scalar(90));
  EXPECT_FALSE(find_borders({view_of(plain), view_of(plain)}).any());
}

TEST(BordersNote, TellsStraightBordersAtOppositeSides) {
  EXPECT_THAT(borders_note(padded(textured(), {15, 15, 40, 40}).view()).value_or(""),
              AllOf(HasSubstr("left 40, right 40, top 15, bottom 15 px"), HasSubstr("1.25 times too large")));
  EXPECT_THAT(borders_note(padded(textured(), {15, 12, 0, 0}, 0).view()).value_or(""), HasSubstr("heights"));
  EXPECT_TRUE(borders_note(padded(textured(), {0, 0, 9, 9}, 255).view()));
}

TEST(BordersNote, PassesOverWhatLensesAndRectificationLeave) {
  EXPECT_FALSE(borders_note(textured().view()));
  EXPECT_FALSE(borders_note(padded(textured(), {0, 15, 40, 0}, 0).view()));         // two sides that meet
  EXPECT_FALSE(borders_note(padded(textured(), {1, 1, 1, 1}, 0).view()));           // thin
  auto unlike = padded(padded(textured(), {15, 0, 0, 0}, 250), {0, 15, 0, 0}, 90);  // a sky and a floor
  EXPECT_FALSE(borders_note(unlike.view()));
  // All pixels kept when the distortion was taken out, and the circle of a fisheye.
  for (const double bend : {0.5, 1.0}) {
    Pictures bent = textured(320, 240);
    for (cv::Mat* image : {&bent.left, &bent.right})
      for (int v = 0; v < image->rows; ++v)
        for (int u = 0; u < image->cols; ++u) {
          const double x = (u - 160) / 160.0, y = (v - 120) / 120.0;
          const double edge = 0.9 - bend * 0.5 * 0.9;
          if (std::abs(y) > edge + bend * 0.4 * (1 - x * x) || std::abs(x) > edge + bend * 0.4 * (1 - y * y))
            image->at<std::uint8_t>(v, u) = 0;
        }
    EXPECT_FALSE(borders_note(bent.view())) << bend;
  }
}

/// The calibration of these images by a file; what it is refused with, or nothing.
std::string refused(const std::string& file, const Pictures& pictures, bool is_resized) {
  CalibrationRequest request;
  ask_for_images(request, pictures.view());
  request.images_are_resized = is_resized;
  return error_of([&] { load_calibration(file, request); });
}

TEST(LoadCalibration, RefusesImagesThatWerePadded) {
  const TemporaryFolder folder;
  const auto sized =
      folder.write("sized.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 60\nbaseline: 0.2\nwidth: 320\nheight: 120\n");
  const auto kitti =
      folder.write("kitti.yaml", "fx: 721.5377\nfy: 721.5377\ncx: 609.5593\ncy: 172.854\nbaseline: 0.54\n");
  const auto twice = folder.write("twice.yaml", "fx: 600\nfy: 600\ncx: 320\ncy: 120\nbaseline: 0.2\n");
  const auto raw = folder.write(
      "raw.yaml",
      "M1: [300, 0, 160, 0, 300, 60, 0, 0, 1]\nD1: [-0.1, 0.01, 0, 0]\nM2: [300, 0, 160, 0, 300, 60, 0, 0, 1]\n"
      "D2: [-0.1, 0.01, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.2, 0, 0]\nimage_width: 320\nimage_height: 120\n");
  const auto boxed = padded(textured(), {100, 100, 0, 0}), kitti_boxed = padded(textured(640, 193), {223, 224, 0, 0});
  for (const bool is_resized : {false, true}) {
    for (const auto& file : {sized, raw})
      EXPECT_THAT(refused(file, boxed, is_resized), HasSubstr("What is inside the borders, 320 x 120 px")) << file;
    EXPECT_THAT(refused(kitti, kitti_boxed, is_resized), HasSubstr("the calibration is for 1242 x 375 px"));
    EXPECT_THAT(refused(twice, boxed, is_resized), HasSubstr("the calibration is for 640 x 240 px"));
  }
  EXPECT_THAT(refused(sized, padded(textured(), {0, 8, 0, 8}, 0, cv::BORDER_REPLICATE), true),
              HasSubstr("left 0, right 8, top 0, bottom 8 px"));
  EXPECT_EQ(refused(sized, textured(), false), "no error");
  EXPECT_EQ(refused(sized, textured(160, 60), false), "no error");
  EXPECT_EQ(refused(sized, textured(400, 120), true), "no error");
  EXPECT_EQ(refused(sized, padded(textured(312, 114), {3, 3, 4, 4}), false), "no error");  // told by `borders_note`
}

}  // namespace
}  // namespace flies
