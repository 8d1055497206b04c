// Recordings through `flies track`: folders of them, kinds that are not read, and our own where they are faulty. Bags
// of ROS 1 are tested in bags_test.cpp, recordings of ROS 2 by their format's own package in tests/page, our own as
// `flies live` writes them in live_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/base64.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/record/mcap_records.hpp"
#include "run_flies.hpp"
#include "street_bag.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST(Recordings, FoldersAndOtherKindsAreToldWhatToGive) {
  const TestFolder folder;
  const auto run = [&](const std::string& source) {
    return run_flies(folder.path(), {"track", source, "--camera-height", "1.65", "--json", "-"});
  };
  const auto drive = folder.path() / "drive";
  std::filesystem::create_directory(drive);
  write_text(drive / "metadata.yaml", "rosbag2_bagfile_information:\n");
  EXPECT_THAT(run("drive").err, HasSubstr("drive: is neither a KITTI raw drive"));
  write_text(drive / "drive_0.db3", "SQLite format 3");
  for (const char* source : {"drive", "drive/metadata.yaml", "drive/drive_0.db3"}) {
    const RunResult result = run(source);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err,
                HasSubstr("drive_0.db3: is a recording in SQLite, which flies does not read: convert it to MCAP"));
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
              {"K", {c.fx_px, 0.0, c.cx_px, 0.0, c.fy_px, c.cy_px, 0.0, 0.0, 1.0}},
              {"P", {c.fx_px, 0.0, c.cx_px, shift, 0.0, c.fy_px, c.cy_px, 0.0, 0.0, 0.0, 1.0, 0.0}}}
      .dump();
}

struct JsonMessage {
  std::string topic, text;
  std::string schema_name = {};  ///< empty: none
  std::uint64_t time_ns = kStart_ns;
};

/// A recording like ours, without chunks: a channel for each message.
void write_mcap(const std::filesystem::path& path, const std::vector<JsonMessage>& messages,
                const std::string& encoding = "json") {
  std::string bytes(mcap::kMagic);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    std::string schema, channel, message;
    if (!messages[i].schema_name.empty()) {
      put_number(schema, i + 1, 2);
      mcap::put_text(schema, messages[i].schema_name);
      mcap::put_record(bytes, mcap::Opcode::schema, schema);
    }
    put_number(channel, i, 2);
    put_number(channel, messages[i].schema_name.empty() ? 0U : i + 1, 2);
    mcap::put_text(channel, messages[i].topic);
    mcap::put_text(channel, encoding);
    put_number(channel, 0, 4);
    mcap::put_record(bytes, mcap::Opcode::channel, channel);
    put_number(message, i, 2);
    put_number(message, 0, 4);
    put_number(message, messages[i].time_ns, 8);
    put_number(message, messages[i].time_ns, 8);
    mcap::put_record(bytes, mcap::Opcode::message, message + messages[i].text);
  }
  mcap::put_record(bytes, mcap::Opcode::data_end, std::string(4, '\0'));
  std::ofstream(path, std::ios::binary) << bytes;
}

/// Of others: their own topics, with a stamp that is not the time at which they were recorded.
TEST(FoxgloveRecordings, PicturesAreInPairsByTheirStampsAndCalibrationStandsBesideThem) {
  const TestFolder folder;
  const auto& [left, right] = street_pair();
  std::vector<JsonMessage> messages;
  for (const bool is_right : {false, true}) {
    const std::string side = is_right ? "/cam/right/" : "/cam/left/";
    messages.push_back({side + "calibration", calibration_message(is_right), "foxglove.CameraCalibration"});
    for (std::uint64_t i = 0; i < 2; ++i) {
      json picture = json::parse(picture_message(is_right ? right : left));
      picture["frame_id"] = "timestamp";  // which is no stamp
      picture["timestamp"] = {{"sec", 1'700'000'000U}, {"nsec", i * 100'000'000U}};
      messages.push_back({side + "image", picture.dump(), "foxglove.CompressedImage",
                          kStart_ns + i * 100'000'000U + (is_right ? 90'000'000U : 0U)});
    }
  }
  write_mcap(folder.path() / "street.mcap", messages);
  const RunResult result = run_flies(folder.path(), {"track", "street.mcap", "--camera-height", "1.65", "--json", "-"});
  ASSERT_EQ(result.status, 0) << result.err;
  ASSERT_EQ(lines(result.out).size(), 2U);
  EXPECT_EQ(json::parse(lines(result.out)[1]).at("time_s"), 0.1);
  EXPECT_THAT(result.err, ::testing::Not(HasSubstr("apart")));
  ASSERT_FALSE(json::parse(lines(result.out)[1]).at("obstacles").empty());
  EXPECT_NEAR(json::parse(lines(result.out)[1])["obstacles"][0]["x_m"].get<double>(), kBoxX_m, 1.0);

  messages[0].text = R"({"width": 320, "height": 240, "K": [1, 2]})";
  write_mcap(folder.path() / "street.mcap", messages);
  EXPECT_EQ(run_flies(folder.path(), {"track", "street.mcap"}).err,
            "flies: street.mcap /cam/left/calibration: K: found 2 numbers, expected 9\n");
}

/// Pictures of both cameras 0.1 s after each other as they were recorded, with these stamps.
void write_stamped(const std::filesystem::path& path, const std::vector<json>& stamps) {
  const auto& [left, right] = street_pair();
  std::vector<JsonMessage> messages;
  for (const bool is_right : {false, true}) {
    const std::string side = is_right ? "/cam/right/" : "/cam/left/";
    messages.push_back({side + "calibration", calibration_message(is_right), "foxglove.CameraCalibration"});
    json picture = json::parse(picture_message(is_right ? right : left));
    picture["meta"] = {{"timestamp", {{"sec", 5}, {"nsec", 0}}}};  // of something else
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      picture["timestamp"] = stamps[i];
      messages.push_back({side + "image", picture.dump(), "foxglove.CompressedImage", kStart_ns + i * 100'000'000U});
    }
  }
  write_mcap(path, messages);
}

TEST(FoxgloveRecordings, StampsAreReadInAllTheirFormsOrTold) {
  const TestFolder folder;
  const auto track = [&](const std::vector<json>& stamps) {
    write_stamped(folder.path() / "street.mcap", stamps);
    const RunResult result =
        run_flies(folder.path(), {"track", "street.mcap", "--camera-height", "1.65", "--json", "-"});
    EXPECT_EQ(result.status, 0) << result.err;
    std::vector<double> times_s;
    for (const auto& line : lines(result.out)) times_s.push_back(json::parse(line).at("time_s"));
    return std::pair(times_s, result.err);
  };
  const std::vector<std::array<json, 2>> forms = {
      {json{{"sec", 1'700'000'000.0}, {"nsec", 0.0}}, json{{"sec", 1'700'000'000.0}, {"nsec", 5e7}}},
      {json{{"sec", "1700000000"}, {"nsec", "0"}}, json{{"sec", "1700000000"}, {"nsec", "50000000"}}},
      {json{{"seconds", 1'700'000'000}}, json{{"seconds", 1'700'000'000}, {"nanos", 50'000'000}}},
      {json{{"secs", 1'700'000'000}, {"nsecs", 0}}, json{{"sec", 1'700'000'000}, {"nanosec", 50'000'000}}},
      {"2023-11-14T22:13:20Z", "2023-11-14T22:13:20.050Z"},
      {"2023-11-14T23:13:20+01:00", "2023-11-14T20:43:20.050000-01:30"},
      {"2023-11-14T23:13:20+0100", "2023-11-14T22:13:20,050Z"}};
  for (const auto& [first, second] : forms) {
    const auto [times_s, err] = track({first, second});
    EXPECT_THAT(times_s, ::testing::ElementsAre(0.0, ::testing::DoubleNear(0.05, 1e-9))) << first << err;
    EXPECT_THAT(err, ::testing::Not(HasSubstr("stamp"))) << first;
  }
  // No text of RFC 3339, no such month, no time zone, beyond what a recording can hold, before 1970.
  const std::vector<std::array<json, 2>> no_stamps = {{"yesterday", "2023-13-14T22:13:20Z"},
                                                      {"2023-11-14T22:13:20", "2023-11-14 22:13:20.050"},
                                                      {"9999-01-01T00:00:00Z", "1969-12-31T23:59:59Z"}};
  for (const auto& [first, second] : no_stamps) {
    const auto [unread_s, unread] = track({first, second});
    EXPECT_THAT(unread_s, ::testing::ElementsAre(0.0, ::testing::DoubleNear(0.1, 1e-9))) << first;
    EXPECT_THAT(unread, HasSubstr("street.mcap: the stamps of 2 pictures of /cam/left/image cannot be read")) << first;
  }

  const auto from_boot = [](int nsec) { return json{{"sec", 5}, {"nsec", nsec}}; };
  const json zero = {{"sec", 0}, {"nsec", 0}};
  const std::vector<std::vector<json>> with_zeros = {{zero, from_boot(100'000'000), from_boot(200'000'000)},
                                                     {from_boot(0), zero, from_boot(200'000'000)}};
  for (const auto& stamps : with_zeros) {
    const auto [times_s, err] = track(stamps);
    EXPECT_THAT(times_s, ::testing::Pointwise(::testing::DoubleNear(1e-9), {0.0, 0.1, 0.2}));
    EXPECT_THAT(err, HasSubstr("1 pictures of /cam/left/image have no stamp (0)"));
  }
}

TEST(FoxgloveRecordings, OthersThatUseOurTopicsAreReadAsTheySay) {
  const TestFolder folder;
  const auto& [left, right] = street_pair();
  const auto track = [&](const std::vector<std::pair<std::string, json>>& calibrations) {
    std::vector<JsonMessage> messages = {{"/left", picture_message(left)}, {"/right", picture_message(right)}};
    for (const auto& [topic, calibration] : calibrations) messages.push_back({topic, calibration.dump()});
    write_mcap(folder.path() / "street.mcap", messages);
    return run_flies(folder.path(), {"track", "street.mcap", "--mount", "given", "--json", "-"});
  };
  const auto nearest_m = [](const RunResult& result) {
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(lines(result.out).at(0)).at("obstacles").at(0).at("range_m").get<double>();
  };
  const json of_left = json::parse(calibration_message(false)), of_right = json::parse(calibration_message(true));
  const RunResult plain = track({{"/left/calibration", of_left}, {"/right/calibration", of_right}});
  EXPECT_THAT(plain.err, ::testing::Not(HasSubstr("rectified first")));
  EXPECT_THAT(plain.err, ::testing::Not(HasSubstr("changes")));

  json bent = of_left, also_bent = of_right;
  bent["D"] = also_bent["D"] = {-0.3, 0.1, 0, 0, 0};
  EXPECT_THAT(track({{"/left/calibration", bent}, {"/right/calibration", also_bent}}).err,
              HasSubstr("taken as raw and rectified first"));
  EXPECT_THAT(track({{"/left/calibration", bent}, {"/right/calibration", of_right}}).err,
              HasSubstr("/right/calibration K: has no distortion coefficients"));
  json ahead = of_left, behind = of_right;  // the same distance, from a place between the cameras
  const double shift = of_right["P"][3].get<double>();
  ahead["P"][3] = -0.5 * shift;
  behind["P"][3] = 0.5 * shift;
  EXPECT_NEAR(nearest_m(track({{"/left/calibration", ahead}, {"/right/calibration", behind}})), nearest_m(plain), 1e-6);
  EXPECT_THAT(
      track({{"/left/calibration", of_left}, {"/right/calibration", of_right}, {"/right/calibration", behind}}).err,
      HasSubstr("/right/calibration changes during the recording: Tx in P"));

  const auto mount = [](double height_m) {
    return json{{"translation", {{"x", 0}, {"y", 0}, {"z", height_m}}},
                {"rotation", {{"x", -0.5}, {"y", 0.5}, {"z", -0.5}, {"w", 0.5}}}};
  };
  const auto mounted = [&](double first_m, double then_m) {
    return track({{"/left/calibration", of_left},
                  {"/right/calibration", of_right},
                  {"/tf/camera", mount(first_m)},
                  {"/tf/camera", mount(then_m)}})
        .err;
  };
  EXPECT_THAT(mounted(1.65, 1.0),
              HasSubstr("the mount of the camera changes during the recording (1.65 m high, 0 degrees "
                        "down and 0 to the right; then 1 m high,"));
  EXPECT_THAT(mounted(1.65, 1.65), ::testing::Not(HasSubstr("changes")));
}

TEST(Recordings, ChannelsWithoutASchemaAreNamed) {
  const TestFolder folder;
  write_mcap(folder.path() / "street.mcap", {{"/left/image", "x"}}, "cdr");
  const RunResult result = run_flies(folder.path(), {"track", "street.mcap"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("holds no pictures that can be read; it holds some of types that flies does not "
                                    "read: /left/image (without a schema, in cdr): 1"));
}

TEST(Recordings, OtherSourcesAreToldTheirCommand) {
  const TestFolder folder;
  const auto fault_of = [&](const std::string& command, const std::string& source) {
    const RunResult result = run_flies(folder.path(), {command, source});
    EXPECT_EQ(result.status, 2);
    return result.err;
  };
  for (const char* source : {"nothere", "nothere.db3"})
    EXPECT_EQ(fault_of("track", source), std::string("flies: ") + source + ": does not exist\n");
  write_text(folder.path() / "both.mp4", "a film");
  EXPECT_THAT(fault_of("track", "both.mp4"), HasSubstr("both.mp4: is a file, expected a recording (.mcap, .bag) or a "
                                                       "folder; films are for flies live"));
  write_bag(folder.path() / "a.bag");
  EXPECT_THAT(fault_of("live", "a.bag"), HasSubstr("a.bag: is a recording"));
  std::filesystem::create_directory(folder.path() / "rosbag2");
  write_bag(folder.path() / "rosbag2/a.bag");
  EXPECT_THAT(fault_of("live", "rosbag2"), HasSubstr("`flies track` reads it"));
}

TEST(OwnRecordings, OptionsOfTheCameraOverruleTheirCalibration) {
  const TestFolder folder;
  const auto& [left, right] = street_pair();
  write_mcap(folder.path() / "street.mcap", {{"/left", picture_message(left)},
                                             {"/right", picture_message(right)},
                                             {"/left/calibration", calibration_message(false)},
                                             {"/right/calibration", calibration_message(true)}});
  const auto nearest_m = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"track", "street.mcap", "--mount", "given", "--json", "-"};
    words.insert(words.end(), more.begin(), more.end());
    const RunResult result = run_flies(folder.path(), words);
    EXPECT_EQ(result.status, 0) << result.err;
    double nearest = std::numeric_limits<double>::infinity();
    const json record = json::parse(lines(result.out).at(0));
    for (const auto& obstacle : record.at("obstacles"))
      nearest = std::min(nearest, obstacle.at("range_m").get<double>());
    return nearest;
  };
  const double as_recorded_m = nearest_m({});
  EXPECT_NEAR(nearest_m({"--baseline", std::to_string(1.1 * street_camera().baseline_m)}), 1.1 * as_recorded_m,
              0.03 * as_recorded_m);
  EXPECT_LT(nearest_m({"--disparity-shift", "3"}), 0.95 * as_recorded_m);
  EXPECT_GT(nearest_m({"--disparity-shift", "-2"}), 1.05 * as_recorded_m);
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
  EXPECT_THAT(good.err, HasSubstr("is damaged where it says how the camera is mounted"));
  for (const std::vector<std::string>& option : {std::vector<std::string>{"--calib-size", "320,240"}, {"--raw"}}) {
    std::vector<std::string> words = {"track", "street.mcap"};
    words.insert(words.end(), option.begin(), option.end());
    EXPECT_THAT(run_flies(folder.path(), words).err,
                HasSubstr("street.mcap: " + option[0] + ": is for a calibration file (--calib)"));
  }
  write_mcap(folder.path() / "street.mcap",
             {{"/left", "x", "foxglove.RawImage"}, {"/right", "x", "foxglove.RawImage"}});
  const RunResult unread = run_flies(folder.path(), {"track", "street.mcap"});
  EXPECT_EQ(unread.status, 2);
  EXPECT_THAT(unread.err, HasSubstr("street.mcap: holds no pictures that can be read; it holds some of types that "
                                    "flies does not read: /left (foxglove.RawImage in json): 1, /right"));
  const RunResult short_one = run(R"({"P": [1, 2, 3]})");
  EXPECT_EQ(short_one.status, 2);
  EXPECT_EQ(short_one.err, "flies: street.mcap /left/calibration: P: found 3 numbers, expected 12\n");
}

}  // namespace
}  // namespace flies::testing
