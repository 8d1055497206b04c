// Recordings through `flies track`: folders of them, kinds that are not read, and our own where they are faulty. Bags
// of ROS 1 are tested in bags_test.cpp, recordings of ROS 2 by their format's own package in tests/page, our own as
// `flies live` writes them in live_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
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
