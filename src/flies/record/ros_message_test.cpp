#include "flies/record/ros_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "flies/core/error.hpp"
#include "flies/io/image_codecs.hpp"
#include "flies/record/ros_bytes.hpp"

namespace flies {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

RecordedMessage message_of(bool is_cdr, const std::string& type, std::string data) {
  return {.topic = "/t",
          .schema_name = is_cdr ? "sensor_msgs/msg/" + type : "sensor_msgs/" + type,
          .encoding = is_cdr ? "cdr" : "ros1",
          .time_ns = 0,
          .data = std::move(data),
          .place = {}};
}

std::vector<int> levels_of(const cv::Mat& picture) {
  cv::Mat levels;
  picture.convertTo(levels, CV_32S);
  return {levels.begin<int>(), levels.end<int>()};
}

TEST(RosMessages, KnowsTypesOfBothVersions) {
  EXPECT_EQ(ros_type(message_of(true, "Image", "")), RosType::image);
  EXPECT_EQ(ros_type(message_of(false, "Image", "")), RosType::image);
  EXPECT_EQ(ros_type(message_of(true, "CompressedImage", "")), RosType::compressed_image);
  EXPECT_EQ(ros_type(message_of(false, "CameraInfo", "")), RosType::camera_info);
  EXPECT_EQ(ros_type(message_of(true, "PointCloud2", "")), RosType::other);
  RecordedMessage json = message_of(true, "Image", "");
  json.encoding = "json";
  EXPECT_EQ(ros_type(json), RosType::other);
}

class RosMessage : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Versions, RosMessage, ::testing::Bool(),
                         [](const auto& version) { return version.param ? "Ros2" : "Ros1"; });

TEST_P(RosMessage, PicturesBecomeGrey) {
  const bool is_cdr = GetParam();
  const std::string rows("\x0A\x14\x1E\xFF\x28\x32\x3C\xFF", 8);  // a byte between the rows
  const auto message = message_of(is_cdr, "Image", testing::ros_image(is_cdr, 5'000'000'007U, 3, 2, "mono8", 4, rows));
  EXPECT_EQ(ros_stamp_ns(message, "m"), 5'000'000'007U);
  const cv::Mat gray = ros_picture(message, "m");
  EXPECT_EQ(gray.cols, 3);
  EXPECT_THAT(levels_of(gray), ElementsAre(10, 20, 30, 40, 50, 60));

  const std::string red("\xFF\0\0", 3);
  const auto color = [&](const char* encoding) {
    return levels_of(
        ros_picture(message_of(is_cdr, "Image", testing::ros_image(is_cdr, 1, 1, 1, encoding, 3, red)), "m"));
  };
  EXPECT_THAT(color("rgb8"), ElementsAre(76));  // ITU-R BT.601
  EXPECT_THAT(color("bgr8"), ElementsAre(29));

  const std::string yuv("\x0A\x80\x14\x80", 4);
  for (const char* encoding : {"yuv422_yuy2", "yuyv"}) {
    const auto pair = message_of(is_cdr, "Image", testing::ros_image(is_cdr, 1, 2, 1, encoding, 4, yuv));
    EXPECT_THAT(levels_of(ros_picture(pair, "m")), ElementsAre(10, 20)) << encoding;
  }
  const std::string uyvy("\x80\x0A\x80\x14", 4);
  for (const char* encoding : {"yuv422", "uyvy"}) {
    const auto pair = message_of(is_cdr, "Image", testing::ros_image(is_cdr, 1, 2, 1, encoding, 4, uyvy));
    EXPECT_THAT(levels_of(ros_picture(pair, "m")), ElementsAre(10, 20)) << encoding;
  }
}

TEST_P(RosMessage, MosaicsBecomeGreyByTheirOwnPattern) {
  const bool is_cdr = GetParam();
  constexpr int kSide = 8;
  std::string red;  // on every second pixel of every second row, from the first on
  for (int i = 0; i < kSide * kSide; ++i) red.push_back(i % 2 == 0 && i / kSide % 2 == 0 ? '\xC8' : '\0');
  const auto middle = [&](const char* encoding) {
    const auto data = testing::ros_image(is_cdr, 1, kSide, kSide, encoding, kSide, red);
    return static_cast<int>(ros_picture(message_of(is_cdr, "Image", data), "m").at<std::uint8_t>(4, 4));
  };
  EXPECT_NEAR(middle("bayer_rggb8"), 0.299 * 200, 1.0);  // ITU-R BT.601
  EXPECT_NEAR(middle("bayer_bggr8"), 0.114 * 200, 1.0);
  EXPECT_EQ(ros_bayer_pattern("bayer_gbrg16"), BayerPattern::gbrg);
  EXPECT_EQ(ros_bayer_pattern("bayer_gbrg8; jpeg compressed bgr8"), std::nullopt) << "colours already";
  EXPECT_EQ(ros_bayer_pattern("bayer_gbrg8; jpeg compressed mono8"), std::nullopt) << "grey already";
  for (const char* of_mosaic :
       {"bayer_gbrg8; jpeg compressed ", "bayer_gbrg8; png compressed bayer_gbrg8", "bayer_gbrg16; png", "bayer_gbrg8"})
    EXPECT_EQ(ros_bayer_pattern(of_mosaic), BayerPattern::gbrg) << of_mosaic;
  EXPECT_EQ(ros_bayer_pattern("mono8; jpeg compressed "), std::nullopt);
}

TEST_P(RosMessage, CompressedMosaicsBecomeGreyByTheirFormatOrAsTheUserSays) {
  const bool is_cdr = GetParam();
  constexpr int kSide = 8;
  cv::Mat red(kSide, kSide, CV_8UC1, cv::Scalar(0));  // on every second pixel of every second row, from the first on
  for (int v = 0; v < kSide; v += 2)
    for (int u = 0; u < kSide; u += 2) red.at<std::uint8_t>(v, u) = 200;
  const auto picture = [&](const char* format, const cv::Mat& pixels, std::optional<BayerPattern> said) -> cv::Mat {
    const auto encoded = encode_png(pixels);
    const std::string png(encoded.begin(), encoded.end());
    const auto data = testing::RosBytes(is_cdr).header(1, 2).text(format).list(png).bytes();
    return ros_picture(message_of(is_cdr, "CompressedImage", data), "m", said);
  };
  const auto middle = [&](const char* format, std::optional<BayerPattern> said = std::nullopt) {
    return static_cast<int>(picture(format, red, said).at<std::uint8_t>(4, 4));
  };
  constexpr double kRed = 0.299 * 200, kBlue = 0.114 * 200;  // ITU-R BT.601
  EXPECT_NEAR(middle("bayer_rggb8; png compressed "), kRed, 1.0);
  EXPECT_NEAR(middle("bayer_bggr8"), kBlue, 1.0);
  EXPECT_NEAR(middle("bayer_rggb8", BayerPattern::bggr), kRed, 1.0) << "the message knows better";
  EXPECT_EQ(middle("mono8; png compressed "), 200);
  EXPECT_NEAR(middle("mono8; png compressed ", BayerPattern::bggr), kBlue, 1.0);
  const cv::Mat colours(kSide, kSide, CV_8UC3, cv::Scalar(0, 0, 200));
  EXPECT_NEAR(picture("bayer_rggb8", colours, std::nullopt).at<std::uint8_t>(4, 4), kRed, 1.0);
  EXPECT_THAT([&] { picture("bgr8; png compressed bgr8", colours, BayerPattern::rggb); },
              ThrowsMessage<InputError>(HasSubstr("m: pixels: found colours, expected the grey levels of a mosaic")));
  const auto plain = testing::ros_image(is_cdr, 1, 2, 1, "bgr8", 6, "abcdef");
  EXPECT_THAT([&] { ros_picture(message_of(is_cdr, "Image", plain), "m", BayerPattern::rggb); },
              ThrowsMessage<InputError>(HasSubstr("found colours")));
}

TEST_P(RosMessage, OfPlanesTheGreyOneCounts) {
  const bool is_cdr = GetParam();
  const auto data = testing::ros_image(is_cdr, 1, 2, 2, "nv21", 2, std::string("\x01\x02\x03\x04\x80\x80", 6));
  EXPECT_THAT(levels_of(ros_picture(message_of(is_cdr, "Image", data), "m")), ElementsAre(1, 2, 3, 4));
}

TEST_P(RosMessage, PicturesOf16BitsKeepThem) {
  const bool is_cdr = GetParam();
  const auto deep = [&](const char* encoding, bool is_big_endian, const std::string& bytes) {
    const auto data =
        testing::ros_image(is_cdr, 1, 1, 1, encoding, static_cast<int>(bytes.size()), bytes, is_big_endian);
    return levels_of(ros_picture(message_of(is_cdr, "Image", data), "m"));
  };
  EXPECT_THAT(deep("mono16", false, std::string("\x34\x12", 2)), ElementsAre(0x1234));
  EXPECT_THAT(deep("mono16", true, std::string("\x12\x34", 2)), ElementsAre(0x1234));
  EXPECT_THAT(deep("rgb16", false, std::string("\0\x10\0\0\0\0", 6)), ElementsAre(1225));  // of red 4096
  EXPECT_THAT(deep("bgr16", true, std::string("\0\0\0\0\x10\0", 6)), ElementsAre(1225));

  const auto png = encode_png(cv::Mat(3, 4, CV_16UC1, cv::Scalar(0x0123)));
  const std::string file(png.begin(), png.end());
  const auto text = testing::RosBytes(is_cdr).header(1, 2).text("mono16; png compressed ").list(file).bytes();
  EXPECT_THAT(levels_of(ros_picture(message_of(is_cdr, "CompressedImage", text), "m")), Each(0x0123));
}

TEST_P(RosMessage, WhatCannotBeReadIsNamed) {
  const bool is_cdr = GetParam();
  const auto picture = [&](const char* encoding, int step, const std::string& bytes) {
    ros_picture(message_of(is_cdr, "Image", testing::ros_image(is_cdr, 1, 2, 2, encoding, step, bytes)), "f.bag /l 3");
  };
  for (const char* encoding : {"32FC1", "bayer_rggb12", "bayer_abcd8"})
    EXPECT_THAT([&] { picture(encoding, 2, "abcd"); },
                ThrowsMessage<InputError>(
                    HasSubstr(std::string("f.bag /l 3: encoding: found '") + encoding + "', expected mono8")));
  EXPECT_THAT([&] { picture("mono8", 2, "abc"); },
              ThrowsMessage<InputError>(HasSubstr("f.bag /l 3: data: found 3 bytes")));
  EXPECT_THAT([&] { picture("mono8", 1, "abcd"); }, ThrowsMessage<InputError>(HasSubstr("rows of 1")));
  std::string cut = testing::ros_image(is_cdr, 1, 2, 2, "mono8", 2, "abcd");
  while (!cut.empty()) {
    cut.pop_back();
    EXPECT_THROW(ros_picture(message_of(is_cdr, "Image", cut), "m"), InputError) << cut.size();
  }
  const auto text = testing::RosBytes(is_cdr).header(1, 2).text("jpeg").list("no picture").bytes();
  EXPECT_THAT([&] { ros_picture(message_of(is_cdr, "CompressedImage", text), "m"); },
              ThrowsMessage<InputError>(HasSubstr("m: ")));
}

TEST_P(RosMessage, CameraInfoIsReadToItsEnd) {
  const bool is_cdr = GetParam();
  const std::string bytes =
      testing::ros_camera_info(is_cdr, 640, 480, 500, -60, {-0.1, 0.01, 0, 0, 0}, 320, 192, {2, 3, 4, 5, 6, 7});
  const auto info = ros_camera_info(message_of(is_cdr, "CameraInfo", bytes), "m");
  EXPECT_EQ(info.topic, "/t");
  EXPECT_EQ(info.width_px, 640);
  EXPECT_EQ(info.height_px, 480);
  EXPECT_EQ(info.distortion_model, "plumb_bob");
  EXPECT_THAT(info.distortion, ElementsAre(-0.1, 0.01, 0, 0, 0));
  EXPECT_EQ(info.intrinsics[5], 192);
  EXPECT_EQ(info.projection[3], -60);
  EXPECT_EQ(info.binning_x, 2);
  EXPECT_EQ(info.binning_y, 3);
  EXPECT_EQ(info.window.x_px, 4);
  EXPECT_EQ(info.window.y_px, 5);
  EXPECT_EQ(info.window.height_px, 6);
  EXPECT_EQ(info.window.width_px, 7);
  for (std::size_t size = 0; size + 1 < bytes.size(); size += 3)
    EXPECT_THROW(ros_camera_info(message_of(is_cdr, "CameraInfo", bytes.substr(0, size)), "m"), InputError) << size;
}

TEST_P(RosMessage, CountsThatNoCameraHasAreToldInTheirUnits) {
  const bool is_cdr = GetParam();
  const auto read = [&](int width, std::uint32_t binning) {
    const auto bytes = testing::ros_camera_info(is_cdr, width, 480, 500, -60, {}, 320, 192, {binning, 1, 0, 0, 0, 0});
    ros_camera_info(message_of(is_cdr, "CameraInfo", bytes), "m");
  };
  EXPECT_THAT([&] { read(70000, 1); },
              ThrowsMessage<InputError>(HasSubstr("m: width: found 70000 px, which no camera has")));
  EXPECT_THAT([&] { read(640, 70000); },
              ThrowsMessage<InputError>(HasSubstr("m: binning_x: found 70000, which no camera has")));
}

TEST(RosMessages, BytesOfEitherOrderAreRead) {
  const std::string data = testing::RosBytes(true, true).header(3, 4).bytes();
  EXPECT_EQ(ros_stamp_ns(message_of(true, "Image", data), "m"), 3'000'000'004U);
}

}  // namespace
}  // namespace flies
