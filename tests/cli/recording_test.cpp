// Recordings through `flies track`: bags of ROS 1, and our own where they are faulty. Recordings of ROS 2 are tested by
// their format's own package in tests/page, our own as `flies live` writes them in live_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/base64.hpp"
#include "flies/record/mcap_records.hpp"
#include "flies/record/ros_bytes.hpp"
#include "run_flies.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

using Numbers = std::vector<double>;

constexpr int kPairs = 3;
constexpr std::uint64_t kStart_ns = 1'700'000'000'000'000'000U;

struct Topics {
  std::string left = "/rig/left/image_raw", right = "/rig/right/image_raw";
  bool has_camera_info = true, has_camera_size = true;
  std::string encoding = "mono8";
  double level_factor = 1.0;                             ///< of the grey levels of mono16
  bool has_left_twice = false;                           ///< the left camera gives another picture 3 ms after each
  std::optional<std::uint64_t> stamp_ns = std::nullopt;  ///< of all pictures; nothing: their own times
  double baseline_factor = 1.0;                          ///< of the baseline that the camera_info has
  Numbers distortion = {};
  std::string before = {};  ///< records before those of the pairs
  std::string after = {};   ///< and after the chunk that holds them
};

std::string pixels_of(const cv::Mat& image) {
  return {reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()};
}

/// A camera that stands before a street; the right pictures come 1 ms after the left ones.
void write_bag(const std::filesystem::path& path, const Topics& topics = {}) {
  const StereoCamera camera = street_camera();
  auto [left, right] = street_pair();
  if (topics.encoding == "mono16")
    for (cv::Mat* picture : {&left, &right}) picture->convertTo(*picture, CV_16U, topics.level_factor);
  std::string records;
  const std::vector<std::string> names = {topics.left, topics.right, "/rig/left/camera_info", "/rig/right/camera_info"};
  for (std::uint32_t i = 0; i < 4; ++i)
    records += BagBytes::connection(i, names[i], i < 2 ? "sensor_msgs/Image" : "sensor_msgs/CameraInfo");
  records += topics.before;
  for (int i = 0; i < kPairs; ++i) {
    const std::uint64_t time_ns = kStart_ns + static_cast<std::uint64_t>(i) * 100'000'000U;
    const auto image = [&](std::uint32_t connection, const cv::Mat& picture, std::uint64_t picture_ns) {
      const auto data =
          ros_image(false, topics.stamp_ns.value_or(picture_ns), picture.cols, picture.rows, topics.encoding,
                    picture.cols * static_cast<int>(picture.elemSize()), pixels_of(picture));
      records += BagBytes::message({connection, picture_ns, data});
    };
    image(0, left, time_ns);
    image(1, right, time_ns + 1'000'000U);
    if (topics.has_left_twice) image(0, left, time_ns + 3'000'000U);
    for (const std::uint32_t connection : {2U, 3U}) {
      if (!topics.has_camera_info) break;
      const double shift = connection == 2 ? 0.0 : -camera.fx_px * camera.baseline_m * topics.baseline_factor;
      records += BagBytes::message({connection, time_ns,
                                    ros_camera_info(false, topics.has_camera_size ? camera.width_px : 0,
                                                    topics.has_camera_size ? camera.height_px : 0, camera.fx_px, shift,
                                                    topics.distortion, camera.cx_px, camera.cy_px)});
    }
  }
  std::ofstream(path, std::ios::binary) << BagBytes::start() << BagBytes::chunk("none", records, records.size())
                                        << topics.after;
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
              HasSubstr("no topic says left or right: /camera/infra1/image is taken for the left one, "
                        "/camera/infra2/image for the right one; --topics LEFT,RIGHT says otherwise"));
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
  EXPECT_EQ(
      result.err,
      "flies: drive.bag: holds no pair, for that takes pictures of two topics; topics with pictures: /left (1)\n");
  std::ofstream(folder.path() / "drive.bag", std::ios::binary | std::ios::app) << "cut";
  result = track(folder, {});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("drive.bag: is cut off or damaged, and what is whole of it holds no pair"));
  result = track(folder, {"--topics", "/left,/right"});
  EXPECT_THAT(result.err, HasSubstr("drive.bag: is cut off or damaged, and what is whole of it holds no pictures in "
                                    "'/right'"));
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

TEST(Recordings, FoldersAndOtherKindsAreToldWhatToGive) {
  const TestFolder folder;
  const auto run = [&](const std::string& source) {
    return run_flies(folder.path(), {"track", source, "--camera-height", "1.65", "--json", "-"});
  };
  const auto drive = folder.path() / "drive";
  std::filesystem::create_directory(drive);
  write_text(drive / "metadata.yaml", "rosbag2_bagfile_information:\n");
  EXPECT_THAT(run("drive").err, HasSubstr("drive: is no KITTI raw drive"));
  write_text(drive / "drive_0.db3", "SQLite format 3");
  for (const char* source : {"drive", "drive/metadata.yaml", "drive/drive_0.db3"}) {
    const RunResult result = run(source);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr("drive_0.db3: is a recording in SQLite, which is not read: convert it to MCAP"));
  }
  write_bag(drive / "a.bag");
  for (const char* source : {"drive", "drive/metadata.yaml"}) {
    const RunResult result = run(source);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(lines(result.out).size(), static_cast<std::size_t>(kPairs));
  }
  write_bag(drive / "b.bag");
  EXPECT_THAT(run("drive").err, HasSubstr("drive: holds 2 recordings, expected one: give one of drive/a.bag, "
                                          "drive/b.bag"));
  write_text(folder.path() / "drive.mcap.zstd", "(");
  EXPECT_THAT(run("drive.mcap.zstd").err, HasSubstr("drive.mcap.zstd: is compressed as a whole: unpack it first"));
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
  EXPECT_THAT(result.err, AllOf(HasSubstr("1 messages of /rig/left/image_raw are left out: they cannot be read; the "
                                          "first: drive.bag /rig/left/image_raw: the message ends too early"),
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
  EXPECT_THAT(track(folder, {}).err, HasSubstr("/rig/left/camera_info: is missing from what is whole of the file"));

  write_bag(folder.path() / "drive.bag", {.encoding = "bayer_rggb8"});
  const RunResult bayer = track(folder, {});
  EXPECT_EQ(bayer.status, 2);
  EXPECT_THAT(bayer.err, HasSubstr("drive.bag /rig/left/image_raw 0: encoding: found 'bayer_rggb8'"));

  write_bag(folder.path() / "drive.bag", {.left = "/left", .right = "/right", .has_camera_info = false});
  const RunResult named_as_ours = track(folder, {});
  EXPECT_EQ(named_as_ours.status, 2);
  EXPECT_THAT(named_as_ours.err, AllOf(HasSubstr("drive.bag: /camera_info: is missing"), HasSubstr("--calib")));
}

std::string picture_message(const cv::Mat& picture) {
  std::vector<std::uint8_t> png;
  cv::imencode(".png", picture, png);
  return json{{"data", to_base64(png)}}.dump();
}

std::string calibration_message(bool is_right) {
  const StereoCamera c = street_camera();
  const double shift = is_right ? -c.fx_px * c.baseline_m : 0.0;
  return json{{"width", c.width_px},
              {"height", c.height_px},
              {"P", {c.fx_px, 0.0, c.cx_px, shift, 0.0, c.fy_px, c.cy_px, 0.0, 0.0, 0.0, 1.0, 0.0}}}
      .dump();
}

/// A recording like ours, without chunks: a message for each topic.
/// @param schema_name of all messages; empty: none
void write_mcap(const std::filesystem::path& path, const std::vector<std::pair<std::string, std::string>>& messages,
                const std::string& schema_name = {}) {
  std::string bytes(mcap::kMagic);
  if (!schema_name.empty()) {
    std::string schema;
    put_number(schema, 1, 2);
    mcap::put_text(schema, schema_name);
    mcap::put_record(bytes, mcap::Opcode::schema, schema);
  }
  for (std::size_t i = 0; i < messages.size(); ++i) {
    std::string channel, message;
    put_number(channel, i, 2);
    put_number(channel, schema_name.empty() ? 0U : 1U, 2);
    mcap::put_text(channel, messages[i].first);
    mcap::put_text(channel, "json");
    put_number(channel, 0, 4);
    mcap::put_record(bytes, mcap::Opcode::channel, channel);
    put_number(message, i, 2);
    put_number(message, 0, 4);
    put_number(message, kStart_ns, 8);
    put_number(message, kStart_ns, 8);
    mcap::put_record(bytes, mcap::Opcode::message, message + messages[i].second);
  }
  mcap::put_record(bytes, mcap::Opcode::data_end, std::string(4, '\0'));
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(OwnRecordings, FaultsOfTheirCalibrationAreNamed) {
  const TestFolder folder;
  const auto& [left, right] = street_pair();
  const auto run = [&](const std::string& left_calibration, const std::string& mount = "{}") {
    write_mcap(folder.path() / "street.mcap", {{"/left", picture_message(left)},
                                               {"/right", picture_message(right)},
                                               {"/left/calibration", left_calibration},
                                               {"/right/calibration", calibration_message(true)},
                                               {"/tf/camera", mount}});
    return run_flies(folder.path(), {"track", "street.mcap", "--camera-height", "1.65", "--json", "-"});
  };
  const RunResult good = run(calibration_message(false));
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_EQ(lines(good.out).size(), 1U);
  EXPECT_THAT(good.err, HasSubstr("is damaged where it says where the camera sits"));
  for (const std::vector<std::string>& option : {std::vector<std::string>{"--calib-size", "320,240"}, {"--raw"}}) {
    std::vector<std::string> words = {"track", "street.mcap"};
    words.insert(words.end(), option.begin(), option.end());
    EXPECT_THAT(run_flies(folder.path(), words).err,
                HasSubstr("street.mcap: " + option[0] + ": is for a calibration file (--calib)"));
  }
  write_mcap(folder.path() / "street.mcap", {{"/left", "x"}, {"/right", "x"}}, "foxglove.RawImage");
  const RunResult unread = run_flies(folder.path(), {"track", "street.mcap"});
  EXPECT_EQ(unread.status, 2);
  EXPECT_THAT(unread.err, HasSubstr("street.mcap: holds no pictures that are read; there are some of kinds that are "
                                    "not read: /left (foxglove.RawImage in json): 1, /right"));
  const RunResult short_one = run(R"({"P": [1, 2, 3]})");
  EXPECT_EQ(short_one.status, 2);
  EXPECT_EQ(short_one.err, "flies: street.mcap: /left/calibration P: found 3 numbers, expected 12\n");
}

}  // namespace
}  // namespace flies::testing
