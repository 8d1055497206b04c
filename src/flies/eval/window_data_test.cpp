#include "flies/eval/window_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>

#include "flies/classify/people_classifier.hpp"
#include "flies/io/output_file.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

void write_noise(const fs::path& file, int width_px, int height_px) {
  fs::create_directories(file.parent_path());
  cv::Mat image(height_px, width_px, CV_8UC1);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 256);
  write_png(file.string(), image);
}

/// Three windows in two sets and two pictures without people.
struct WindowDataTest : ::testing::Test {
  WindowDataTest() : root(folder.file("data")) {
    write_noise(root / "positives/b/1.png", 64, 128);
    write_noise(root / "positives/b/2.png", 64, 128);
    write_noise(root / "positives/a/deep/3.png", 80, 160);
    write_noise(root / "negatives/1.png", 200, 150);
    write_noise(root / "negatives/more/2.png", 120, 300);
  }
  testing::TemporaryFolder folder;
  fs::path root;
};

/// A classifier whose score is the width of the window.
std::vector<double> width_of(const GrayView&, std::span<const ImageBox> windows) {
  std::vector<double> scores;
  for (const auto& window : windows) scores.push_back(window.width_px);
  return scores;
}

TEST_F(WindowDataTest, FindsSetsAndPictures) {
  const WindowData data = open_window_data(root);
  ASSERT_EQ(data.positives.size(), 2u);
  EXPECT_EQ(data.positives[0].name, "a");
  EXPECT_EQ(data.positives[0].files.size(), 1u);
  EXPECT_EQ(data.positives[1].files.size(), 2u);
  EXPECT_EQ(data.negatives.size(), 2u);
  EXPECT_EQ(count_pictures(data), 5u);
}

TEST_F(WindowDataTest, TakesWindowsWithoutSubFolderAsASet) {
  write_noise(root / "positives/4.png", 64, 128);
  const WindowData data = open_window_data(root);
  ASSERT_EQ(data.positives.size(), 3u);
  EXPECT_EQ(data.positives[2].name, "positives");
}

TEST_F(WindowDataTest, SharesTheNegativesOutAndLooksAtWholePositives) {
  const WindowClassifier classifiers[] = {width_of, width_of};
  std::size_t last = 0;
  const auto scores = score_windows(open_window_data(root), classifiers, {.negatives = 7, .min_height_px = 100},
                                    [&](std::size_t done) { last = done; });
  ASSERT_EQ(scores.size(), 2u);
  EXPECT_THAT(scores[0].positives[0].scores, ::testing::ElementsAre(80.0));
  EXPECT_THAT(scores[0].positives[1].scores, ::testing::ElementsAre(64.0, 64.0));
  EXPECT_EQ(scores[0].negatives[0].size(), 4u);
  EXPECT_EQ(scores[0].negatives[1].size(), 3u);
  EXPECT_EQ(scores[0].negatives, scores[1].negatives) << "all classifiers see the same windows";
  EXPECT_EQ(last, 5u);
}

TEST_F(WindowDataTest, NamesWhatIsWrong) {
  const auto fault = [&] {
    return testing::error_of([&] {
      const WindowClassifier classifier = width_of;
      score_windows(open_window_data(root), {&classifier, 1}, {.negatives = 4});
    });
  };
  EXPECT_EQ(fault(), "no error");
  write_noise(root / "positives/b/wide.png", 100, 128);
  EXPECT_THAT(fault(), HasSubstr("wide.png: size: found 100 x 128 px"));
  fs::remove(root / "positives/b/wide.png");
  fs::remove_all(root / "negatives");
  EXPECT_THAT(fault(), HasSubstr("negatives: not found"));
  fs::create_directories(root / "negatives");
  EXPECT_THAT(fault(), HasSubstr("negatives: holds no pictures"));
  write_noise(root / "negatives/small.png", 70, 60);
  EXPECT_THAT(fault(), HasSubstr("small.png: size"));
  EXPECT_THAT(testing::error_of([] { open_window_data("/nowhere"); }), HasSubstr("/nowhere: is not a folder"));
}

TEST(DrawWindows, StayInsideThePictureWithTheDetectorsAspect) {
  const auto windows = draw_windows(300, 200, 1000, {}, 0);
  ASSERT_EQ(windows.size(), 1000u);
  for (const auto& window : windows) {
    EXPECT_GE(window.u_px, 0.0);
    EXPECT_GE(window.v_px, 0.0);
    EXPECT_LE(window.u_px + window.width_px, 300.0);
    EXPECT_LE(window.v_px + window.height_px, 200.0);
    EXPECT_DOUBLE_EQ(2.0 * window.width_px, window.height_px);
    EXPECT_GE(window.height_px, 80.0);
  }
}

TEST(DrawWindows, HaveLogUniformHeights) {
  // Half of the heights from 80 to 320 px lie below their geometric mean, 160; 3 standard errors of 4000 draws.
  constexpr double kTolerance = 0.024;
  const auto windows = draw_windows(1000, 320, 4000, {}, 0);
  ASSERT_EQ(windows.size(), 4000u);
  const auto low = std::count_if(windows.begin(), windows.end(), [](const auto& w) { return w.height_px < 160.0; });
  EXPECT_NEAR(static_cast<double>(low) / 4000.0, 0.5, kTolerance);
}

TEST(DrawWindows, DifferFromPictureToPictureAndRepeatWithTheSeed) {
  const auto first = [](std::uint32_t picture, std::uint64_t seed) {
    return draw_windows(500, 400, 1, {.seed = seed}, picture).front().u_px;
  };
  EXPECT_NE(first(0, 1), first(1, 1));
  EXPECT_NE(first(0, 1), first(0, 2));
  EXPECT_EQ(first(0, 1), first(0, 1));
}

TEST(DrawWindows, AreNoneInASmallPicture) {
  EXPECT_TRUE(draw_windows(39, 400, 5, {}, 0).empty());
  EXPECT_FALSE(draw_windows(41, 400, 5, {}, 0).empty());
}

/// Data that OpenCV's detectors were measured on beforehand, with ten times as many windows without people: 94.8 and
/// 89.3 % at 1e-2 and 1e-3 false positives a window.
TEST(ScoreWindows, AgreesWithWhatIsKnownOfOpenCvsDetector) {
  const auto folder = testing::find_data("people/test");
  if (!folder) GTEST_SKIP() << testing::absence("people/test");
  // 204 and 20 windows decide: a few points more or less from draw to draw.
  constexpr double kTolerance2 = 0.025, kTolerance3 = 0.05;
  constexpr double kFalsePositives[] = {1e-2, 1e-3};
  const WindowClassifier classifier = [model = people_classifier("opencv-64x128")](const GrayView& image,
                                                                                   std::span<const ImageBox> windows) {
    return model->classify(image, windows);
  };
  const auto scores = score_windows(open_window_data(*folder), {&classifier, 1}, {.negatives = 20400});
  const auto rates = detection_rates(scores.front(), kFalsePositives, {.resamples = 0});
  EXPECT_NEAR(rates.at(0).rate, 0.948, kTolerance2);
  EXPECT_NEAR(rates.at(1).rate, 0.893, kTolerance3);
}

}  // namespace
}  // namespace flies
