// Recordings of others: bags of ROS 1 through `flies track`. Recordings of ROS 2 are tested by their format's own
// package in tests/page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "flies/record/ros_bytes.hpp"
#include "run_flies.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kPairs = 3;

struct Topics {
  std::string left = "/rig/left/image_raw", right = "/rig/right/image_raw";
  bool has_camera_info = true;
  std::string encoding = "mono8";
  bool has_left_twice = false;  ///< the left camera gives another picture 3 ms after each
};

std::string pixels_of(const cv::Mat& image) { return {reinterpret_cast<const char*>(image.data), image.total()}; }

/// A camera that stands before a street; the right pictures come 1 ms after the left ones.
void write_bag(const std::filesystem::path& path, const Topics& topics = {}) {
  const StereoCamera camera = street_camera();
  const auto& [left, right] = street_pair();
  std::string records;
  const std::vector<std::string> names = {topics.left, topics.right, "/rig/left/camera_info", "/rig/right/camera_info"};
  for (std::uint32_t i = 0; i < 4; ++i)
    records += BagBytes::connection(i, names[i], i < 2 ? "sensor_msgs/Image" : "sensor_msgs/CameraInfo");
  for (int i = 0; i < kPairs; ++i) {
    const std::uint64_t time_ns = 1'700'000'000'000'000'000U + static_cast<std::uint64_t>(i) * 100'000'000U;
    const auto image = [&](std::uint32_t connection, const cv::Mat& picture, std::uint64_t stamp_ns) {
      const auto data =
          ros_image(false, stamp_ns, picture.cols, picture.rows, topics.encoding, picture.cols, pixels_of(picture));
      records += BagBytes::message({connection, stamp_ns, data});
    };
    image(0, left, time_ns);
    image(1, right, time_ns + 1'000'000U);
    if (topics.has_left_twice) image(0, left, time_ns + 3'000'000U);
    for (const std::uint32_t connection : {2U, 3U}) {
      if (!topics.has_camera_info) break;
      const double shift = connection == 2 ? 0.0 : -camera.fx_px * camera.baseline_m;
      records += BagBytes::message({connection, time_ns,
                                    ros_camera_info(false, camera.width_px, camera.height_px, camera.fx_px, shift, {},
                                                    camera.cx_px, camera.cy_px)});
    }
  }
  std::ofstream(path, std::ios::binary) << BagBytes::start() << BagBytes::chunk("none", records, records.size());
}

RunResult track(const TestFolder& folder, std::vector<std::string> more) {
  more.insert(more.begin(), {"track", "drive.bag", "--camera-height", "1.65", "--json", "-"});
  return run_flies(folder.path(), more);
}

TEST(Bags, PairsAndCalibrationOfOthersAreFollowed) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag");
  const RunResult result = track(folder, {});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto records = lines(result.out);
  ASSERT_EQ(records.size(), static_cast<std::size_t>(kPairs));
  const json last = json::parse(records.back());
  EXPECT_NEAR(last.at("time_s").get<double>(), 0.2, 1e-6);
  EXPECT_EQ(last.at("left"), "drive.bag /rig/left/image_raw 2");
  ASSERT_FALSE(last.at("obstacles").empty());
  EXPECT_NEAR(last["obstacles"][0]["x_m"].get<double>(), kBoxX_m, 1.0);
  EXPECT_NEAR(last["obstacles"][0]["y_m"].get<double>(), kBoxY_m, 1.0);
}

TEST(Bags, TopicsMayBeNamed) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag", {.left = "/rig/left/a", .right = "/rig/right/b"});
  const RunResult unclear = track(folder, {});
  EXPECT_EQ(unclear.status, 2);
  EXPECT_THAT(unclear.err, AllOf(HasSubstr("--topics LEFT,RIGHT"), HasSubstr("/rig/left/a (3), /rig/right/b (3)")));
  const RunResult named = track(folder, {"--topics", "/rig/left/a,/rig/right/b"});
  EXPECT_EQ(named.status, 0) << named.err;
  EXPECT_EQ(lines(named.out).size(), static_cast<std::size_t>(kPairs));
  const RunResult wrong = track(folder, {"--topics", "/rig/left/a,/rig/right/c"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("no pictures in '/rig/right/c'"), HasSubstr("/rig/right/b (3)")));
}

TEST(Bags, NoPictureIsInTwoPairs) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag", {.has_left_twice = true});
  const RunResult result = track(folder, {});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(lines(result.out).size(), static_cast<std::size_t>(kPairs));
  EXPECT_THAT(result.err, HasSubstr("3 pictures of /rig/left/image_raw have no partner"));
}

TEST(Bags, WhatIsMissingIsNamed) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag", {.has_camera_info = false});
  const RunResult result = track(folder, {});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("drive.bag: /rig/left/camera_info: is missing"), HasSubstr("--calib")));
  write_text(folder.path() / "calib.txt", kitti_calibration());
  EXPECT_EQ(track(folder, {"--calib", "calib.txt"}).status, 0);

  write_bag(folder.path() / "drive.bag", {.encoding = "bayer_rggb8"});
  const RunResult bayer = track(folder, {});
  EXPECT_EQ(bayer.status, 2);
  EXPECT_THAT(bayer.err, HasSubstr("drive.bag /rig/left/image_raw 0: encoding: found 'bayer_rggb8'"));
}

}  // namespace
}  // namespace flies::testing
