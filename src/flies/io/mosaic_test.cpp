#include "flies/io/mosaic.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "flies/io/images.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::pair<const char*, BayerPattern> kPatterns[] = {{"rggb", BayerPattern::rggb},
                                                              {"bggr", BayerPattern::bggr},
                                                              {"grbg", BayerPattern::grbg},
                                                              {"gbrg", BayerPattern::gbrg}};

/// A picture of coloured patches and fine texture, with black and white in a corner, so that nothing is stretched.
cv::Mat colors(int seed, int width_px = 160, int height_px = 120) {
  cv::RNG random(static_cast<std::uint64_t>(seed));
  cv::Mat coarse(9, 12, CV_8UC3), picture, fine(height_px, width_px, CV_8UC1);
  random.fill(coarse, cv::RNG::UNIFORM, 40, 200);
  cv::resize(coarse, picture, {width_px, height_px}, 0.0, 0.0, cv::INTER_LINEAR);
  random.fill(fine, cv::RNG::UNIFORM, 0, 40);
  cv::GaussianBlur(fine, fine, {0, 0}, 1.0);
  cv::cvtColor(fine, fine, cv::COLOR_GRAY2BGR);
  picture += fine;
  picture(cv::Rect(0, 0, 8, 8)).setTo(cv::Scalar::all(2));
  picture(cv::Rect(8, 0, 8, 8)).setTo(cv::Scalar::all(253));
  return picture;
}

/// One channel a pixel, as the letters of the pattern say.
cv::Mat mosaic_of(const cv::Mat& bgr, const std::string& pattern) {
  cv::Mat mosaic(bgr.size(), CV_8UC1);
  for (int v = 0; v < bgr.rows; ++v)
    for (int u = 0; u < bgr.cols; ++u) {
      const char color = pattern[static_cast<std::size_t>(v % 2 * 2 + u % 2)];
      mosaic.at<std::uint8_t>(v, u) = bgr.at<cv::Vec3b>(v, u)[static_cast<int>(std::string("bgr").find(color))];
    }
  return mosaic;
}

cv::Mat gray_of(const cv::Mat& bgr) {
  cv::Mat gray;
  cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

GrayView view_of(const cv::Mat& gray) { return {gray.data, gray.cols, gray.rows, gray.cols}; }

TEST(Demosaiced, IsTheGrayOfTheColours) {
  const cv::Mat bgr = colors(3);
  for (const auto& [name, pattern] : kPatterns) {
    ASSERT_EQ(bayer_pattern_of(name), pattern);
    const cv::Mat inside = demosaiced(mosaic_of(bgr, name), pattern);
    cv::Mat difference;
    cv::absdiff(inside, gray_of(bgr), difference);
    constexpr double kInterpolation_gray = 4.0;  // on average; another pattern is 8 and more off
    EXPECT_LT(cv::mean(difference)[0], kInterpolation_gray) << name;
    cv::absdiff(demosaiced(mosaic_of(bgr, name), name[0] == 'g' ? BayerPattern::rggb : BayerPattern::grbg),
                gray_of(bgr), difference);
    EXPECT_GT(cv::mean(difference)[0], 2.0 * kInterpolation_gray) << name;
  }
  EXPECT_FALSE(bayer_pattern_of("rgbg"));
}

TEST(RecogniseMosaic, TellsWhereTheGreensAre) {
  const cv::Mat bgr = colors(5);
  for (const auto& [name, pattern] : kPatterns)
    EXPECT_EQ(recognise_mosaic(view_of(mosaic_of(bgr, name))),
              name[0] == 'g' ? MosaicGreens::first : MosaicGreens::beside)
        << name;
}

TEST(RecogniseMosaic, TakesNoImageForOne) {
  EXPECT_FALSE(recognise_mosaic(view_of(gray_of(colors(5)))));
  for (const int square_px : {1, 2, 3, 8}) {  // a checkerboard
    cv::Mat board(64, 96, CV_8UC1);
    for (int v = 0; v < board.rows; ++v)
      for (int u = 0; u < board.cols; ++u)
        board.at<std::uint8_t>(v, u) = (u / square_px + v / square_px) % 2 == 0 ? 30 : 220;
    EXPECT_FALSE(recognise_mosaic(view_of(board))) << square_px;
  }
  cv::Mat noise(64, 96, CV_8UC1);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_FALSE(recognise_mosaic(view_of(noise)));
  const std::uint8_t pixel = 9;
  EXPECT_FALSE(recognise_mosaic({&pixel, 1, 1, 1}));
}

TEST(RecogniseMosaic, TellsRealMosaicsFromRealImages) {
  const auto reports = testing::find_data("reports/pictures"), streets = testing::find_data("kitti_stereo2012");
  if (!reports || !streets) GTEST_SKIP() << testing::absence("reports/pictures or kitti_stereo2012");
  for (const char* const side : {"left", "right"})
    EXPECT_TRUE(
        recognise_mosaic(load_gray_image((*reports / ("000274-" + std::string(side) + ".png")).string()).view()));
  int images = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*streets / "image_0")) {
    EXPECT_FALSE(recognise_mosaic(load_gray_image(entry.path().string()).view())) << entry.path();
    ++images;
  }
  EXPECT_GT(images, 10);
}

TEST(LoadPair, MakesGrayOfMosaicsAndRefusesColours) {
  const testing::TemporaryFolder folder;
  const auto save = [&](const std::string& name, const cv::Mat& image) {
    cv::imwrite(folder.file(name), image);
    return folder.file(name);
  };
  const cv::Mat left = colors(1), right = colors(2);
  const PairPaths paths{save("l.png", mosaic_of(left, "gbrg")), save("r.png", mosaic_of(right, "gbrg"))};
  const auto pair = load_pair(paths, {.bayer = BayerPattern::gbrg});
  const cv::Mat expected = demosaiced(mosaic_of(right, "gbrg"), BayerPattern::gbrg);
  EXPECT_TRUE(std::equal(pair.right.pixels.begin(), pair.right.pixels.end(), expected.data));
  EXPECT_THAT(mosaic_note(load_pair(paths, {}).view()).value_or(""), HasSubstr("--bayer grbg or gbrg"));
  EXPECT_FALSE(mosaic_note(pair.view()));
  EXPECT_THAT(pair.notes, IsEmpty());
  EXPECT_THAT(load_pair(paths, {.bayer = BayerPattern::rggb}).notes, ElementsAre(HasSubstr("like grbg or gbrg")));
  const PairPaths colored{save("cl.png", left), save("cr.png", right)};
  EXPECT_THAT(testing::error_of([&] { load_pair(colored, {.bayer = BayerPattern::gbrg}); }),
              AllOf(HasSubstr("cl.png"), HasSubstr("colours")));
}

TEST(LoadPair, SplitsAFileOfBothImages) {
  const testing::TemporaryFolder folder;
  const cv::Mat left = gray_of(colors(1)), right = gray_of(colors(2));
  cv::Mat beside, above;
  cv::hconcat(left, right, beside);
  cv::vconcat(left, right, above);
  for (const auto& [word, both] : {std::pair("side", beside), std::pair("tb", above)}) {
    const auto path = folder.file("both.png");
    cv::imwrite(path, both);
    const auto pair = load_pair({path, path}, {.split = split_of(word).value()});
    ASSERT_EQ(pair.left.width_px, left.cols);
    ASSERT_EQ(pair.left.height_px, left.rows);
    EXPECT_TRUE(std::equal(pair.left.pixels.begin(), pair.left.pixels.end(), left.data)) << word;
    EXPECT_TRUE(std::equal(pair.right.pixels.begin(), pair.right.pixels.end(), right.data)) << word;
  }
  const auto odd = folder.file("odd.png");
  cv::imwrite(odd, beside(cv::Rect(0, 0, beside.cols - 1, beside.rows)));
  EXPECT_THAT(testing::error_of([&] {
                load_pair({odd, odd}, {.split = Split::side_by_side});
              }),
              AllOf(HasSubstr("odd.png"), HasSubstr("319 x 120"), HasSubstr("cannot be halved")));
}

}  // namespace
}  // namespace flies
