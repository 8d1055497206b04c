#include "flies/record/ros_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "flies/core/error.hpp"
#include "flies/record/ros_bytes.hpp"
#include "flies/record/ros_calibration.hpp"

namespace flies {
namespace {

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
  const GrayImage gray = ros_picture(message, "m");
  EXPECT_EQ(gray.width_px, 3);
  EXPECT_THAT(gray.pixels, ElementsAre(10, 20, 30, 40, 50, 60));

  const std::string red("\xFF\0\0", 3);
  const auto color = [&](const char* encoding) {
    return ros_picture(message_of(is_cdr, "Image", testing::ros_image(is_cdr, 1, 1, 1, encoding, 3, red)), "m").pixels;
  };
  EXPECT_THAT(color("rgb8"), ElementsAre(76));  // ITU-R BT.601
  EXPECT_THAT(color("bgr8"), ElementsAre(29));

  const auto deep = [&](bool is_big_endian, const std::string& bytes) {
    const auto data = testing::ros_image(is_cdr, 1, 1, 1, "mono16", 2, bytes, is_big_endian);
    return ros_picture(message_of(is_cdr, "Image", data), "m").pixels;
  };
  EXPECT_THAT(deep(false, std::string("\x00\x40", 2)), ElementsAre(64));
  EXPECT_THAT(deep(true, std::string("\x40\x00", 2)), ElementsAre(64));
}

TEST_P(RosMessage, WhatCannotBeReadIsNamed) {
  const bool is_cdr = GetParam();
  const auto picture = [&](const char* encoding, int step, const std::string& bytes) {
    ros_picture(message_of(is_cdr, "Image", testing::ros_image(is_cdr, 1, 2, 2, encoding, step, bytes)), "f.bag /l 3");
  };
  EXPECT_THAT([&] { picture("bayer_rggb8", 2, "abcd"); },
              ThrowsMessage<InputError>(HasSubstr("f.bag /l 3: encoding: found 'bayer_rggb8', expected mono8")));
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

TEST_P(RosMessage, CameraInfoGivesTheCalibration) {
  const bool is_cdr = GetParam();
  const auto info = [&](double shift, const std::vector<double>& distortion) {
    return ros_camera_info(
        message_of(is_cdr, "CameraInfo", testing::ros_camera_info(is_cdr, 640, 480, 500, shift, distortion)), "m");
  };
  const RosCameraInfo left = info(0.0, {}), right = info(-60.0, {});
  EXPECT_EQ(left.width_px, 640);
  EXPECT_EQ(left.distortion_model, "plumb_bob");
  EXPECT_TRUE(is_rectified_by_nature(left));
  const Calibration rectified = ros_calibration(left, right, true, "f");
  EXPECT_FALSE(rectified.rectifier.has_value());
  EXPECT_DOUBLE_EQ(rectified.camera.baseline_m, 0.12);
  EXPECT_DOUBLE_EQ(rectified.camera.fx_px, 500);
  EXPECT_DOUBLE_EQ(rectified.camera.cy_px, 192);

  const RosCameraInfo bent_left = info(0.0, {-0.1, 0.01, 0, 0, 0}), bent_right = info(-60.0, {-0.1, 0.01, 0, 0, 0});
  EXPECT_FALSE(is_rectified_by_nature(bent_left));
  const Calibration raw = ros_calibration(bent_left, bent_right, false, "f");
  ASSERT_TRUE(raw.rectifier.has_value());
  EXPECT_NEAR(raw.camera.baseline_m, 0.12, 1e-9);

  EXPECT_THAT([&] { ros_calibration(right, left, true, "f"); },
              ThrowsMessage<InputError>(HasSubstr("are left and right swapped?")));
  for (const std::size_t number : {0U, 5U, 6U}) {  // fx, fy, cy
    RosCameraInfo other = right;
    other.projection[number] += 30.0;
    EXPECT_THAT([&] { ros_calibration(left, other, true, "f"); },
                ThrowsMessage<InputError>(HasSubstr("in both images of a rectified pair")));
  }
  RosCameraInfo far = bent_right;
  far.projection[3] = -1e9;
  EXPECT_THAT([&] { ros_calibration(bent_left, far, false, "f"); }, ThrowsMessage<InputError>(HasSubstr("baseline")));
  RosCameraInfo odd = bent_left;
  odd.distortion_model = "thin_prism";
  EXPECT_THAT([&] { ros_calibration(odd, bent_right, false, "f"); },
              ThrowsMessage<InputError>(HasSubstr("distortion_model: found 'thin_prism'")));
}

/// A turned right camera: R of both give the rotation between them back.
TEST(RosCalibration, RotationsOfBothCamerasAreUsed) {
  RosCameraInfo left, right;
  for (RosCameraInfo* camera : {&left, &right}) {
    camera->width_px = 640;
    camera->height_px = 480;
    camera->intrinsics = {500, 0, 320, 0, 500, 240, 0, 0, 1};
    camera->distortion = {0, 0, 0, 0, 0};
    camera->projection = {500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0};
  }
  right.projection[3] = -50;
  const double c = std::cos(0.02), s = std::sin(0.02);
  left.rectification = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  right.rectification = {c, 0, s, 0, 1, 0, -s, 0, c};
  const Calibration calibration = ros_calibration(left, right, false, "f");
  ASSERT_TRUE(calibration.rectifier.has_value());
  EXPECT_NEAR(calibration.camera.baseline_m, 0.1, 1e-6);
  EXPECT_NEAR(calibration.camera.fx_px, 500, 25);
}

TEST(RosMessages, BytesOfEitherOrderAreRead) {
  const std::string data = testing::RosBytes(true, true).header(3, 4).bytes();
  EXPECT_EQ(ros_stamp_ns(message_of(true, "Image", data), "m"), 3'000'000'004U);
}

}  // namespace
}  // namespace flies
