#include "flies/eval/hog_yardstick.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flies/io/images.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

StereoCamera camera_of(int width_px, int height_px) {
  return {.fx_px = 500,
          .fy_px = 500,
          .cx_px = width_px / 2.0,
          .cx_right_px = width_px / 2.0,
          .cy_px = height_px / 2.0,
          .baseline_m = 0.5,
          .width_px = width_px,
          .height_px = height_px,
          .mount = {.height_m = 1.2}};
}

GrayView view_of(const cv::Mat& image) { return {image.data, image.cols, image.rows, static_cast<int>(image.step)}; }

TEST(DetectPeopleByHog, RefusesAStrideThatDoesNotFitTheBlocks) {
  const cv::Mat image(240, 320, CV_8UC1, cv::Scalar(90));
  EXPECT_THAT(testing::error_of([&] {
                detect_people_by_hog(view_of(image), camera_of(320, 240), HogDetector::hog_48x96, 0.0,
                                     {.stride_px = 12});
              }),
              ::testing::HasSubstr("hog.stride_px"));
}

TEST(DetectPeopleByHog, FindsNobodyInAWall) {
  const cv::Mat image(240, 320, CV_8UC1, cv::Scalar(90));
  for (const auto detector : {HogDetector::hog_48x96, HogDetector::hog_64x128}) {
    const auto found = detect_people_by_hog(view_of(image), camera_of(320, 240), detector, 1.0);
    EXPECT_TRUE(found.people.empty());
    EXPECT_GT(found.time_ms, 0.0);
  }
}

/// Needs a photograph of a person, which cannot be made up.
TEST(DetectPeopleByHog, FindsAPersonOfTheRightHeightWhereItStands) {
  const char* photographs = "people/train/positives/inria";
  const auto folder = testing::find_data(photographs);
  if (!folder) GTEST_SKIP() << testing::absence(photographs);
  // Dozens of windows with people 96 px high, each in the middle of a grey picture.
  constexpr int kWidth_px = 320, kHeight_px = 240, kLeft_px = 120, kTop_px = 90, kPictures = 30;
  int pictures = 0, found_right = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
    if (pictures++ == kPictures) break;
    const GrayImage window = load_gray_image(entry.path().string());
    cv::Mat image(kHeight_px, kWidth_px, CV_8UC1, cv::Scalar(110));
    for (int v = 0; v < window.height_px; ++v)
      for (int u = 0; u < window.width_px; ++u)
        image.at<std::uint8_t>(kTop_px + v, kLeft_px + u) =
            window.pixels[static_cast<std::size_t>(v * window.width_px + u)];
    const StereoCamera camera = camera_of(kWidth_px, kHeight_px);
    const auto found = detect_people_by_hog(view_of(image), camera, HogDetector::hog_64x128, 0.0);
    const double range_m = camera.fy_px * 1.7 / 96.0;
    found_right += std::any_of(found.people.begin(), found.people.end(), [&](const Pedestrian& person) {
      return std::abs(person.range_m / range_m - 1.0) < 0.15 &&
             std::abs(person.box.u_px + person.box.width_px / 2.0 - (kLeft_px + 32.0)) < 15.0;
    });
  }
  // OpenCV's detector was trained on these photographs; a box one stride or scale off is still near enough.
  EXPECT_GE(found_right, kPictures * 2 / 3);
}

TEST(DetectPeopleByHog, ChecksItsOptions) {
  const cv::Mat image(240, 320, CV_8UC1, cv::Scalar(90));
  for (const HogOptions& options : {HogOptions{.enlarge = 0.0}, HogOptions{.scale_step = 1.0}})
    EXPECT_THROW(detect_people_by_hog(view_of(image), camera_of(320, 240), HogDetector::hog_48x96, 1.0, options),
                 InputError);
}

}  // namespace
}  // namespace flies
