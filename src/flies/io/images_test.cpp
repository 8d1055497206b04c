#include "flies/io/images.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::read_all;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kWidth_px = 96;
constexpr int kHeight_px = 64;

/// Noise of a seed, grey levels below `limit`.
cv::Mat noise(int type, int seed, double limit, int width_px = kWidth_px) {
  cv::Mat image(kHeight_px, width_px, type);
  cv::RNG random(static_cast<std::uint64_t>(seed));
  random.fill(image, cv::RNG::UNIFORM, 0.0, limit);
  return image;
}

std::string save(const TemporaryFolder& folder, const std::string& name, const cv::Mat& image) {
  const std::string path = folder.file(name);
  EXPECT_TRUE(cv::imwrite(path, image)) << path;
  return path;
}

TEST(LoadGrayImage, ReadsLosslessFormatsExactly) {
  const TemporaryFolder folder;
  const cv::Mat gray = noise(CV_8UC1, 1, 256);
  for (const char* name : {"a.png", "a.pgm", "a.tif"}) {
    const auto image = load_gray_image(save(folder, name, gray));
    ASSERT_EQ(image.width_px, kWidth_px) << name;
    ASSERT_EQ(image.height_px, kHeight_px) << name;
    EXPECT_TRUE(std::equal(image.pixels.begin(), image.pixels.end(), gray.data)) << name;
  }
}

TEST(LoadGrayImage, ReadsJpeg) {
  const TemporaryFolder folder;
  cv::Mat gray;
  cv::GaussianBlur(noise(CV_8UC1, 1, 256), gray, {0, 0}, 3);
  const auto image = load_gray_image(save(folder, "a.jpg", gray));
  constexpr int kCompression_gray = 8;
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u)
      ASSERT_NEAR(image.view().at(u, v), gray.at<std::uint8_t>(v, u), kCompression_gray);
}

TEST(LoadGrayImage, WeighsColoursAndIgnoresAlpha) {
  const TemporaryFolder folder;
  cv::Mat color(kHeight_px, kWidth_px, CV_8UC4, cv::Scalar(200, 100, 50, 17));
  color.at<cv::Vec4b>(0, 0) = {0, 0, 0, 255};
  const auto image = load_gray_image(save(folder, "a.png", color));
  EXPECT_EQ(image.view().at(5, 5), 96);  // 0.114 * 200 + 0.587 * 100 + 0.299 * 50, ITU-R BT.601
  EXPECT_EQ(image.view().at(0, 0), 0);
}

TEST(LoadPair, ShiftsBoth16BitImagesAlike) {
  const TemporaryFolder folder;
  cv::Mat left = noise(CV_16UC1, 1, 3600), right = noise(CV_16UC1, 2, 3600);
  right.at<std::uint16_t>(3, 4) = 4095;  // 12 bits in all
  left.at<std::uint16_t>(3, 4) = 3000;
  for (const char* extension : {".png", ".tif", ".pgm"}) {
    const auto pair =
        load_pair(save(folder, std::string("l") + extension, left), save(folder, std::string("r") + extension, right));
    EXPECT_EQ(pair.bit_depth, 12) << extension;
    EXPECT_EQ(pair.right.view().at(4, 3), 255) << extension;
    EXPECT_EQ(pair.left.view().at(4, 3), 3000 >> 4) << extension;
  }
}

/// Waves of 16 bits.
cv::Mat smooth_levels(int seed) {
  cv::Mat levels(kHeight_px, kWidth_px, CV_16UC1);
  for (int v = 0; v < levels.rows; ++v)
    for (int u = 0; u < levels.cols; ++u)
      levels.at<std::uint16_t>(v, u) =
          static_cast<std::uint16_t>(2000.0 + 1900.0 * std::sin(0.13 * u + 0.21 * v + seed));
  return levels;
}

cv::Mat exchanged(const cv::Mat& levels) {
  cv::Mat result = levels.clone(), bytes = result.reshape(1);
  for (auto& level : cv::Mat_<std::uint16_t>(bytes)) level = static_cast<std::uint16_t>(level << 8 | level >> 8);
  return result;
}

TEST(LoadPair, ExchangesTheBytesOf16BitLevelsThatStandInTheOtherOrder) {
  const TemporaryFolder folder;
  const cv::Mat left = smooth_levels(0), right = smooth_levels(1);
  const auto good = load_pair(save(folder, "l.pgm", left), save(folder, "r.pgm", right));
  const auto pair = load_pair(save(folder, "le.pgm", exchanged(left)), save(folder, "re.pgm", exchanged(right)));
  EXPECT_TRUE(good.notes.empty());
  EXPECT_EQ(pair.left.pixels, good.left.pixels);
  EXPECT_EQ(pair.right.pixels, good.right.pixels);
  EXPECT_THAT(pair.notes, ::testing::ElementsAre(::testing::HasSubstr("bytes of the 16-bit levels")));
  EXPECT_EQ(load_gray_image(folder.file("le.pgm")).pixels, load_gray_image(folder.file("l.pgm")).pixels);
}

TEST(LoadPair, ExchangesBytesOfOneImageOnlyAndOfColours) {
  const TemporaryFolder folder;
  const cv::Mat left = smooth_levels(0), right = smooth_levels(1);
  const auto good = load_pair(save(folder, "l.pgm", left), save(folder, "r.pgm", right));
  const auto one = load_pair(folder.file("l.pgm"), save(folder, "re.pgm", exchanged(right)));
  EXPECT_EQ(one.left.pixels, good.left.pixels);
  EXPECT_EQ(one.right.pixels, good.right.pixels);
  EXPECT_THAT(one.notes, ElementsAre(HasSubstr("16-bit levels of the right image are in the wrong order")));
  const auto coloured = [](const cv::Mat& levels) {
    cv::Mat color;
    cv::merge(std::vector<cv::Mat>{levels, levels / 2, levels / 3}, color);
    return color;
  };
  const auto color = load_pair(save(folder, "lc.png", coloured(left)), save(folder, "rc.png", coloured(right)));
  const auto turned = load_pair(save(folder, "lce.png", exchanged(coloured(left))),
                                save(folder, "rce.png", exchanged(coloured(right))));
  EXPECT_THAT(color.notes, IsEmpty());
  EXPECT_EQ(turned.left.pixels, color.left.pixels);
  EXPECT_EQ(turned.right.pixels, color.right.pixels);
  EXPECT_THAT(turned.notes, ElementsAre(HasSubstr("bytes of the 16-bit levels are in the wrong order")));
}

TEST(LoadPair, SeesTheSceneInSpiteOfAHotPixel) {
  const TemporaryFolder folder;
  cv::Mat left = noise(CV_16UC1, 1, 1000), right = noise(CV_16UC1, 2, 1000);
  right.at<std::uint16_t>(3, 4) = 65535;
  const auto pair = load_pair(save(folder, "l.png", left), save(folder, "r.png", right));
  const int level = left.at<std::uint16_t>(9, 7);
  EXPECT_NEAR(pair.left.view().at(7, 9), level * 255 / 1000, 2);
  EXPECT_EQ(pair.right.view().at(4, 3), 255);
}

TEST(LoadPair, StretchesANarrowBandOfLevelsAlikeInBoth) {
  const TemporaryFolder folder;
  const cv::Mat left = noise(CV_16UC1, 1, 60) + cv::Scalar(20000), right = noise(CV_16UC1, 2, 60) + cv::Scalar(20010);
  const auto pair = load_pair(save(folder, "l.png", left), save(folder, "r.png", right));
  // From 20000 to 20069 in all.
  const auto expected = [](std::uint16_t level) { return (level - 20000) * 255 / 69; };
  EXPECT_NEAR(pair.left.view().at(7, 9), expected(left.at<std::uint16_t>(9, 7)), 5);
  EXPECT_NEAR(pair.right.view().at(7, 9), expected(right.at<std::uint16_t>(9, 7)), 5);
}

/// Soft blotches of 8 bits, from `offset` to `levels` above it.
cv::Mat blotches(int seed, int levels, int offset) {
  cv::Mat image;
  cv::GaussianBlur(noise(CV_8UC1, seed, 256), image, {0, 0}, 2.0);
  cv::normalize(image, image, offset, offset + levels, cv::NORM_MINMAX);
  return image;
}

class FaintPairs : public ::testing::Test {
 protected:
  GrayPair load(const cv::Mat& left, const cv::Mat& right) {
    return load_pair(save(folder_, "l.png", left), save(folder_, "r.png", right));
  }

  TemporaryFolder folder_;
};

TEST_F(FaintPairs, AreStretchedAlike) {
  const cv::Mat left = blotches(1, 40, 100);
  const auto pair = load(left, blotches(2, 40, 100));
  EXPECT_NEAR(pair.left.view().at(7, 9), (left.at<std::uint8_t>(9, 7) - 96) * 255 / 48, 32);
  EXPECT_THAT(pair.notes, ElementsAre(HasSubstr("lie in a narrow band")));
  auto again = pair;
  stretch_faint(again);
  EXPECT_EQ(again.left.pixels, pair.left.pixels);
  EXPECT_EQ(again.notes.size(), 1U);
}

TEST_F(FaintPairs, AreStretchedInSpiteOfABlackBorderAndABurntSky) {
  cv::Mat left = blotches(1, 40, 100), right = blotches(2, 40, 100);
  const auto without = load(left, right);
  for (cv::Mat* image : {&left, &right}) {
    image->rowRange(0, 8).setTo(0);
    image->colRange(0, 4).setTo(255);
  }
  const auto pair = load(left, right);
  EXPECT_NEAR(pair.left.view().at(50, 40), without.left.view().at(50, 40), 40);
  EXPECT_THAT(pair.notes, ElementsAre(HasSubstr("lie in a narrow band")));
}

TEST_F(FaintPairs, OfACameraAreStretchedAsThoseOfFiles) {
  const cv::Mat left = blotches(1, 40, 100), right = blotches(2, 40, 100);
  const auto of_files = load(left, right);
  GrayPair of_camera{{kWidth_px, kHeight_px, {left.begin<std::uint8_t>(), left.end<std::uint8_t>()}},
                     {kWidth_px, kHeight_px, {right.begin<std::uint8_t>(), right.end<std::uint8_t>()}}};
  stretch_faint(of_camera);
  EXPECT_EQ(of_camera.left.pixels, of_files.left.pixels);
  EXPECT_EQ(of_camera.right.pixels, of_files.right.pixels);
  EXPECT_EQ(of_camera.notes, of_files.notes);
}

TEST_F(FaintPairs, OfContrastEnoughOrOfNoiseAloneAreLeftAsTheyAre) {
  for (const auto& [left, right] :
       {std::pair(blotches(1, 200, 20), blotches(2, 200, 20)), std::pair(blotches(1, 10, 100), blotches(2, 10, 100)),
        std::pair<cv::Mat, cv::Mat>(noise(CV_8UC1, 1, 30), noise(CV_8UC1, 2, 30))}) {
    const auto pair = load(left, right);
    EXPECT_TRUE(std::equal(pair.left.pixels.begin(), pair.left.pixels.end(), left.begin<std::uint8_t>()));
    EXPECT_THAT(pair.notes, IsEmpty());
  }
}

TEST(LoadPair, StretchesEachImageByItsOwnLevelsWhereTheyHardlyOverlap) {
  const TemporaryFolder folder;
  const auto is_stretched = [](const GrayImage& image) {
    const auto [least, most] = std::ranges::minmax_element(image.pixels);
    return *least == 0 && *most == 255;
  };
  const cv::Mat eight_bits = noise(CV_16UC1, 1, 250), twelve_bits = noise(CV_16UC1, 2, 3600) + cv::Scalar(240);
  const auto bits = load_pair(save(folder, "l.png", eight_bits), save(folder, "r.png", twelve_bits));
  EXPECT_TRUE(is_stretched(bits.left));
  EXPECT_TRUE(is_stretched(bits.right));
  const cv::Mat low = noise(CV_16UC1, 1, 500) + cv::Scalar(20000), high = noise(CV_16UC1, 2, 500) + cv::Scalar(29900);
  const auto offsets = load_pair(save(folder, "l.png", low), save(folder, "r.png", high));
  EXPECT_TRUE(is_stretched(offsets.left));
  EXPECT_TRUE(is_stretched(offsets.right));
  EXPECT_THAT(offsets.notes, ElementsAre(AllOf(HasSubstr("left 2000"), HasSubstr("right 299"))));
  const cv::Mat alike = noise(CV_16UC1, 2, 500) + cv::Scalar(20100);
  EXPECT_THAT(load_pair(save(folder, "l.png", low), save(folder, "r.png", alike)).notes, IsEmpty());
}

TEST(LoadPair, TellsThatTiffFilesHoldFurtherImages) {
  const TemporaryFolder folder;
  const auto save_all = [&](const std::string& name, const std::vector<cv::Mat>& images) {
    cv::imwritemulti(folder.file(name), images);
    return folder.file(name);
  };
  const cv::Mat first = noise(CV_8UC1, 1, 256), second = noise(CV_8UC1, 2, 256), wide = noise(CV_8UC1, 3, 256, 100);
  const auto pages = load_pair(save_all("l.tif", {first, wide, second}), save_all("r.tif", {second, first}));
  EXPECT_THAT(pages.notes, ElementsAre(HasSubstr("further images of this size")));
  EXPECT_EQ(pages.right.view().at(7, 9), second.at<std::uint8_t>(9, 7));
  EXPECT_THAT(load_pair(save_all("l.tif", {first}), save_all("r.tif", {second, wide})).notes, IsEmpty())
      << "a thumbnail";
}

TEST(LoadPair, LeavesSmall16BitValuesUnshifted) {
  const TemporaryFolder folder;
  const cv::Mat left = noise(CV_16UC1, 1, 200);
  const auto pair = load_pair(save(folder, "l.png", left), save(folder, "r.png", noise(CV_16UC1, 2, 200)));
  EXPECT_EQ(pair.bit_depth, 8);
  EXPECT_EQ(pair.left.view().at(7, 9), left.at<std::uint16_t>(9, 7));
}

TEST(LoadPair, RejectsPairsThatAreNone) {
  const TemporaryFolder folder;
  const auto left = save(folder, "left.png", noise(CV_8UC1, 1, 256));
  const auto other_size = save(folder, "wide.png", noise(CV_8UC1, 2, 256, 100));
  const auto other_depth = save(folder, "deep.png", noise(CV_16UC1, 2, 65536));
  EXPECT_THAT(error_of([&] { load_pair(left, other_size); }),
              AllOf(HasSubstr("wide.png"), HasSubstr("100 x 64"), HasSubstr("96 x 64")));
  EXPECT_THAT(error_of([&] { load_pair(left, other_depth); }), AllOf(HasSubstr("16 bits"), HasSubstr("8 bits")));
  EXPECT_THAT(error_of([&] { load_pair(left, left); }), HasSubstr("identical"));
  const auto copy = folder.write("copy.png", read_all(left));
  EXPECT_THAT(error_of([&] { load_pair(left, copy); }), AllOf(HasSubstr("copy.png"), HasSubstr("identical")));
}

TEST(LoadGrayImage, RejectsImagesWithoutContent) {
  const TemporaryFolder folder;
  const cv::Mat black(kHeight_px, kWidth_px, CV_8UC1, cv::Scalar(0)),
      white(kHeight_px, kWidth_px, CV_8UC3, cv::Scalar::all(255));
  EXPECT_THAT(error_of([&] { load_gray_image(save(folder, "black.png", black)); }),
              AllOf(HasSubstr("black.png"), HasSubstr("grey level 0")));
  EXPECT_THAT(error_of([&] { load_gray_image(save(folder, "white.jpg", white)); }), HasSubstr("grey level 255"));
  EXPECT_THAT(error_of([&] { load_gray_image(save(folder, "dot.png", cv::Mat(1, 1, CV_8UC1, cv::Scalar(9)))); }),
              HasSubstr("found 1 x 1 px"));
  cv::Mat real(kHeight_px, kWidth_px, CV_32F, cv::Scalar(0.5));
  EXPECT_THAT(error_of([&] { load_gray_image(save(folder, "real.tif", real)); }), HasSubstr("floating point"));
  real.at<float>(2, 2) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(error_of([&] { load_gray_image(save(folder, "nan.tif", real)); }), HasSubstr("not finite"));
}

TEST(LoadGrayImage, RejectsWhatIsNoImage) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { load_gray_image(folder.file("none.png")); }),
              AllOf(HasSubstr("none.png"), HasSubstr("No such file")));
  EXPECT_THAT(error_of([&] { load_gray_image(folder.file("")); }), HasSubstr("is a folder"));
  EXPECT_THAT(error_of([&] { load_gray_image(folder.write("text.png", "Hello, this is text.")); }),
              HasSubstr("is not an image"));
  EXPECT_THAT(error_of([&] { load_gray_image(folder.write("empty.png", "")); }), HasSubstr("is empty"));
}

class ImageFormats : public ::testing::TestWithParam<const char*> {};

TEST_P(ImageFormats, AreRejectedWhenTruncatedAnywhere) {
  const TemporaryFolder folder;
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const std::string extension = GetParam();
    if (extension == (type == CV_8UC3 ? ".pgm" : ".ppm")) continue;
    const auto bytes = read_all(save(folder, "whole" + extension, noise(type, 1, 256)));
    for (const double share : {0.1, 0.5, 0.9, 0.99}) {
      const auto kept = static_cast<std::size_t>(share * static_cast<double>(bytes.size()));
      const auto path = folder.write("cut" + extension, bytes.substr(0, kept));
      ::testing::internal::CaptureStderr();
      EXPECT_THAT(error_of([&] { load_gray_image(path); }), AllOf(HasSubstr("cut"), HasSubstr("truncated")))
          << share << " of type " << type;
      EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << share;
    }
    if (extension == ".tif") continue;  // ends with an offset that a single image does not need
    const auto path = folder.write("cut" + extension, bytes.substr(0, bytes.size() - 1));
    EXPECT_THAT(error_of([&] { load_gray_image(path); }), HasSubstr("truncated")) << "last byte";
  }
}

INSTANTIATE_TEST_SUITE_P(Each, ImageFormats, ::testing::Values(".png", ".jpg", ".pgm", ".ppm", ".tif"),
                         [](const auto& test) { return std::string(test.param).substr(1); });

TEST(LoadGrayImage, AcceptsBytesBehindTheEndOfAJpeg) {
  const TemporaryFolder folder;
  const auto bytes = read_all(save(folder, "a.jpg", noise(CV_8UC1, 1, 256)));
  EXPECT_EQ(load_gray_image(folder.write("b.jpg", bytes + "camera data")).width_px, kWidth_px);
}

TEST(LoadGrayImage, RejectsDamagedPng) {
  const TemporaryFolder folder;
  auto bytes = read_all(save(folder, "a.png", noise(CV_8UC1, 1, 256)));
  bytes[bytes.size() / 2] = static_cast<char>(~bytes[bytes.size() / 2]);
  EXPECT_THAT(error_of([&] { load_gray_image(folder.write("b.png", bytes)); }), HasSubstr("is damaged"));
}

TEST(LoadGrayImage, ReadsTextPgmWithComments) {
  const TemporaryFolder folder;
  std::string text = "P2 # a comment\n64 48\n255\n";
  for (int i = 0; i < 64 * 48; ++i) text += std::to_string(i % 200) + (i % 16 == 15 ? "\n" : " ");
  EXPECT_EQ(load_gray_image(folder.write("a.pgm", text)).view().at(5, 0), 5);
  EXPECT_THAT(error_of([&] { load_gray_image(folder.write("b.pgm", text.substr(0, 5000))); }), HasSubstr("truncated"));
}

}  // namespace
}  // namespace flies
