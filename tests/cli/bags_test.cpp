// Bags of ROS 1 through `flies track`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/record/ros_bytes.hpp"
#include "run_flies.hpp"
#include "street_bag.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

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

/// 16 bits hold anything from 8 significant ones up, in recordings as in files.
TEST(Bags, PicturesOf16BitsAreReadByTheBitsThatTheyUse) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag");
  const auto obstacles = [&] {
    const RunResult result = track(folder, {"--seed", "1"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(lines(result.out).back()).at("obstacles");
  };
  const json of_8_bits = obstacles();
  ASSERT_FALSE(of_8_bits.empty());
  for (const double factor : {1.0, 4.0, 16.0, 256.0}) {
    write_bag(folder.path() / "drive.bag", {.encoding = "mono16", .level_factor = factor});
    EXPECT_EQ(obstacles(), of_8_bits) << factor;
  }
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

/// Pictures that hold both images, as a stereo camera under usb_cam gives them, and no calibration.
void write_joined(const std::filesystem::path& path, const std::vector<std::string>& topics, bool is_side = true) {
  const auto& [left, right] = street_pair();
  cv::Mat both;
  if (is_side)
    cv::hconcat(left, right, both);
  else
    cv::vconcat(left, right, both);
  std::string records;
  for (std::uint32_t i = 0; i < topics.size(); ++i) {
    records += BagBytes::connection(i, topics[i], "sensor_msgs/Image");
    for (std::uint64_t time_ns = kStart_ns; time_ns < kStart_ns + kPairs * 100'000'000U; time_ns += 100'000'000U)
      records += BagBytes::message(
          {i, time_ns, ros_image(false, time_ns, both.cols, both.rows, "mono8", both.cols, pixels_of(both))});
  }
  std::ofstream(path, std::ios::binary) << BagBytes::start() << BagBytes::chunk("none", records, records.size());
}

TEST(Bags, OneTopicMayHoldBothImages) {
  const TestFolder folder;
  write_street(folder.path());
  const auto sees_the_box = [](const RunResult& result) {
    ASSERT_EQ(result.status, 0) << result.err;
    ASSERT_EQ(lines(result.out).size(), static_cast<std::size_t>(kPairs));
    const json last = json::parse(lines(result.out).back());
    EXPECT_NEAR(last.at("obstacles").at(0).at("x_m").get<double>(), kBoxX_m, 1.0);
    EXPECT_NEAR(last.at("time_s").get<double>(), 0.2, 1e-9);
  };
  const auto refused = [&](const std::vector<std::string>& words, const std::string& expected) {
    const RunResult result = track(folder, words);
    EXPECT_EQ(result.status, 2) << expected;
    EXPECT_THAT(result.err, HasSubstr(expected));
  };
  write_joined(folder.path() / "drive.bag", {"/stereo/image_raw"});
  sees_the_box(track(folder, {"--split", "side", "--topics", "/stereo/image_raw", "--calib", "calib.txt"}));
  sees_the_box(track(folder, {"--split", "side", "--calib", "calib.txt"}));
  refused({"--split", "side"}, "--calib: is missing");
  refused({"--calib", "calib.txt"}, "or --split if each picture holds both images");
  refused({"--calib", "calib.txt", "--topics", "/stereo/image_raw"}, "--topics: found one topic, expected LEFT,RIGHT");
  refused({"--split", "side", "--calib", "calib.txt", "--topics", "/a,/b"}, "--topics: found two topics, expected one");
  refused({"--split", "side", "--calib", "calib.txt", "--topics", "/a"}, "no pictures in '/a' (--topics)");
  write_joined(folder.path() / "drive.bag", {"/stereo/image_raw", "/other/image_raw"}, false);
  sees_the_box(track(folder, {"--split", "top", "--topics", "/stereo/image_raw", "--calib", "calib.txt"}));
  refused({"--split", "top", "--calib", "calib.txt"}, "name the one that holds both images with --topics TOPIC");
}

/// One picture of each of these topics at one time.
void write_topics(const std::filesystem::path& path, const std::vector<std::string>& topics) {
  std::string records;
  for (std::uint32_t i = 0; i < topics.size(); ++i) {
    const auto& [left, right] = street_pair();
    const bool is_left = std::ranges::any_of(std::array{"eft", "EFT", "infra1", "cam09"}, [&](const char* word) {
      return topics[i].find(word) != std::string::npos;
    });
    const auto& picture = is_left ? left : right;
    records += BagBytes::connection(i, topics[i], "sensor_msgs/Image");
    records += BagBytes::message(
        {i, kStart_ns,
         ros_image(false, kStart_ns, picture.cols, picture.rows, "mono8", picture.cols, pixels_of(picture))});
  }
  std::ofstream(path, std::ios::binary) << BagBytes::start() << BagBytes::chunk("none", records, records.size());
}

TEST(Bags, TheWordForTheSideTellsTheTopics) {
  const TestFolder folder;
  write_text(folder.path() / "calib.txt", kitti_calibration());
  const auto left_of = [&](const std::vector<std::string>& topics) -> std::string {
    write_topics(folder.path() / "drive.bag", topics);
    const RunResult result = track(folder, {"--calib", "calib.txt"});
    return result.status == 0 ? json::parse(lines(result.out).back()).at("left") : json(result.err);
  };
  EXPECT_EQ(left_of({"/Left/image", "/Right/image"}), "drive.bag /Left/image 0");
  EXPECT_EQ(left_of({"/LEFT/image", "/RIGHT/image"}), "drive.bag /LEFT/image 0");
  EXPECT_EQ(left_of({"/rightarm/left/image", "/rightarm/right/image"}), "drive.bag /rightarm/left/image 0");
  EXPECT_EQ(left_of({"/right/left/image", "/right/right/image"}), "drive.bag /right/left/image 0");
  EXPECT_EQ(left_of({"/left/left_image", "/right/right_image"}), "drive.bag /left/left_image 0");
  EXPECT_EQ(left_of({"/leftcam/image", "/rightcam/image"}), "drive.bag /leftcam/image 0");
  EXPECT_EQ(left_of({"/left/image_rect", "/right/image_rect", "/left/image_rect_color", "/right/image_rect_color"}),
            "drive.bag /left/image_rect 0");
  EXPECT_EQ(left_of({"/left/image_raw", "/right/image_raw", "/left/image_color", "/right/image_color"}),
            "drive.bag /left/image_color 0");
  EXPECT_EQ(left_of({"/left/image_rect_color", "/right/image_rect_color", "/left_raw/image", "/right_raw/image"}),
            "drive.bag /left/image_rect_color 0");
  EXPECT_EQ(left_of({"/camera/infra2/image", "/camera/infra1/image"}), "drive.bag /camera/infra1/image 0");
  EXPECT_EQ(left_of({"/cam10/image", "/cam09/image"}), "drive.bag /cam09/image 0");
  EXPECT_THAT(left_of({"/cam0/image", "/cam1/image", "/cam2/image"}),
              HasSubstr("cannot tell the left pictures from the right ones"));
  EXPECT_THAT(left_of({"/front/left/image", "/front/right/image", "/rear/left/image", "/rear/right/image"}),
              HasSubstr("cannot tell the left pictures from the right ones"));
}

TEST(Bags, TopicsThatNumbersTellAreNamed) {
  const TestFolder folder;
  write_text(folder.path() / "calib.txt", kitti_calibration());
  write_topics(folder.path() / "drive.bag", {"/camera/infra1/image", "/camera/infra2/image"});
  EXPECT_THAT(track(folder, {"--calib", "calib.txt"}).err,
              HasSubstr("no topic name says left or right: /camera/infra1/image is taken as the left one, "
                        "/camera/infra2/image as the right one; choose others with --topics LEFT,RIGHT"));
}

TEST(Bags, MessagesThatNothingDescribesAreToldOnce) {
  const TestFolder folder;
  std::string lost;
  for (int i = 0; i < 100; ++i) lost += BagBytes::message({9, kStart_ns, "x"});
  write_bag(folder.path() / "drive.bag", {.before = lost});
  const RunResult result = track(folder, {});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(lines(result.out).size(), static_cast<std::size_t>(kPairs));
  EXPECT_THAT(result.err,
              HasSubstr("there are messages of connections that it does not describe; that part of the file "
                        "is left out"));
}

TEST(Bags, PicturesOfOneSideAloneOfAFileThatWasCutOff) {
  const TestFolder folder;
  write_topics(folder.path() / "drive.bag", {"/left"});
  RunResult result = track(folder, {});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err,
            "flies: drive.bag: holds no pairs, which need pictures of two topics, or --split if each picture "
            "holds both images; topics with pictures: /left (1)\n");
  std::ofstream(folder.path() / "drive.bag", std::ios::binary | std::ios::app) << "cut";
  result = track(folder, {});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("drive.bag: is cut off or damaged, and the intact part of it holds no pair"));
  result = track(folder, {"--topics", "/left,/right"});
  EXPECT_THAT(result.err,
              HasSubstr("drive.bag: is cut off or damaged, and the intact part of it holds no pictures in '/right'"));
}

TEST(Bags, PicturesOfEitherSideWithoutPartnersAreCounted) {
  const TestFolder folder;
  std::string alone;
  for (int i = 1; i < 4; ++i) {
    const auto& right = street_pair().right;
    const std::uint64_t time_ns = kStart_ns - static_cast<std::uint64_t>(i) * 100'000'000U;
    alone += BagBytes::message(
        {1, time_ns, ros_image(false, time_ns, right.cols, right.rows, "mono8", right.cols, pixels_of(right))});
  }
  write_bag(folder.path() / "drive.bag", {.before = alone});
  EXPECT_THAT(track(folder, {}).err, HasSubstr("3 pictures of /rig/right/image_raw have no partner"));
}

TEST(Bags, NoPictureIsInTwoPairs) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag", {.has_left_twice = true});
  const RunResult result = track(folder, {});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(lines(result.out).size(), static_cast<std::size_t>(kPairs));
  EXPECT_THAT(result.err, HasSubstr("3 pictures of /rig/left/image_raw have no partner"));
}

TEST(Bags, BaselineOfTheUserOverrulesTheirs) {
  const TestFolder folder;
  for (const auto& distortion : {Numbers{}, Numbers{1e-9, 0, 0, 0, 0}}) {  // the latter: a rectifier
    write_bag(folder.path() / "drive.bag", {.baseline_factor = 0.5, .distortion = distortion});
    const RunResult result = track(folder, {"--baseline", std::to_string(street_camera().baseline_m)});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("the baseline is"));
    const json last = json::parse(lines(result.out).back());
    EXPECT_NEAR(last.at("run").at("camera").at("baseline_m").get<double>(), street_camera().baseline_m, 1e-5);
    ASSERT_FALSE(last.at("obstacles").empty());
    EXPECT_NEAR(last["obstacles"][0]["x_m"].get<double>(), kBoxX_m, 1.0);
  }
}

TEST(Bags, OptionsOfCalibrationFilesAreRefusedWithoutOne) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag");
  const std::vector<std::vector<std::string>> options = {{"--right-calib", "right.yaml"}, {"--cameras", "2,3"}};
  for (const auto& option : options) {
    const RunResult result = track(folder, option);
    EXPECT_EQ(result.status, 2) << option[0];
    EXPECT_THAT(result.err, HasSubstr("drive.bag: " + option[0] + ": is for a calibration file (--calib)"));
  }
}

TEST(Bags, SizeOfTheCalibrationMayBeSaidWhereTheyDoNot) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag", {.has_camera_size = false});
  const StereoCamera camera = street_camera();
  const auto read = [&](int factor) {
    return track(folder, {"--calib-size",
                          std::to_string(factor * camera.width_px) + "," + std::to_string(factor * camera.height_px)});
  };
  const RunResult same = read(1), halved = read(2);
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_THAT(same.err, Not(HasSubstr("scaled by")));
  EXPECT_THAT(halved.err, HasSubstr("scaled by 0.5 to the images"));
}

TEST(Bags, PicturesWithoutStampsHaveTheTimesOfTheirMessages) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag", {.stamp_ns = 0});
  const RunResult result = track(folder, {});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto records = lines(result.out);
  ASSERT_EQ(records.size(), static_cast<std::size_t>(kPairs));
  EXPECT_NEAR(json::parse(records.back()).at("time_s").get<double>(), 0.2, 1e-6);
}

TEST(Bags, PicturesOfOneTimeAreCounted) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag", {.stamp_ns = kStart_ns});
  const RunResult result = track(folder, {});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(lines(result.out).size(), 1U);
  for (const char* side : {"left", "right"})
    EXPECT_THAT(result.err, HasSubstr("2 pictures of /rig/" + std::string(side) + "/image_raw are left out"));
}

TEST(Bags, FaultyMessagesArePassedOver) {
  const TestFolder folder;
  const auto cut = [](std::uint32_t connection) { return BagBytes::message({connection, kStart_ns, "cut"}); };
  const std::string other = BagBytes::connection(4, "/other/camera_info", "sensor_msgs/CameraInfo") + cut(4);
  write_bag(folder.path() / "drive.bag", {.before = other + cut(0)});
  const RunResult result = track(folder, {});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(lines(result.out).size(), static_cast<std::size_t>(kPairs));
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("1 messages of /rig/left/image_raw are left out, because they cannot be read; the first "
                              "error: drive.bag /rig/left/image_raw: the message ends too early"),
                    Not(HasSubstr("/other")), Not(HasSubstr("damaged"))));

  write_bag(folder.path() / "drive.bag", {.has_camera_info = false, .before = cut(2)});
  const RunResult needed = track(folder, {});
  EXPECT_EQ(needed.status, 2);
  EXPECT_THAT(needed.err, HasSubstr("drive.bag /rig/left/camera_info: the message ends too early"));
}

TEST(Bags, WhatIsPassedOverIsTold) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag", {.after = BagBytes::chunk("zip", "x", 1)});
  const RunResult result = track(folder, {});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(lines(result.out).size(), static_cast<std::size_t>(kPairs));
  EXPECT_THAT(result.err, HasSubstr("drive.bag: chunks are compressed with 'zip', expected none, zstd, lz4 or bz2; "
                                    "that part of the file is left out"));
}

TEST(Bags, WhatIsMissingIsNamed) {
  const TestFolder folder;
  write_bag(folder.path() / "drive.bag", {.has_camera_info = false});
  const RunResult result = track(folder, {});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("drive.bag: /rig/left/camera_info: is missing"), HasSubstr("--calib")));
  write_text(folder.path() / "calib.txt", kitti_calibration());
  EXPECT_EQ(track(folder, {"--calib", "calib.txt"}).status, 0);
  write_bag(folder.path() / "drive.bag", {.has_camera_info = false, .after = "cut"});
  EXPECT_THAT(track(folder, {}).err, HasSubstr("/rig/left/camera_info: is missing from the intact part of the file"));

  write_bag(folder.path() / "drive.bag", {.encoding = "32FC1"});
  const RunResult floats = track(folder, {});
  EXPECT_EQ(floats.status, 2);
  EXPECT_THAT(floats.err, HasSubstr("drive.bag /rig/left/image_raw 0: encoding: found '32FC1'"));

  write_bag(folder.path() / "drive.bag", {.left = "/left", .right = "/right", .has_camera_info = false});
  const RunResult named_as_ours = track(folder, {});
  EXPECT_EQ(named_as_ours.status, 2);
  EXPECT_THAT(named_as_ours.err, AllOf(HasSubstr("drive.bag: /camera_info: is missing"), HasSubstr("--calib")));
}

}  // namespace
}  // namespace flies::testing
