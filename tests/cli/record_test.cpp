#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "run_flies.hpp"
#include "spoilt_street.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using Records = std::vector<json>;

std::string text_of(const json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

/// The options that make the run of a record again, from the record alone.
Words options_of(const json& record) {
  const json& run = record.at("run");
  const json& mount = run.at("mount");
  const auto degrees = [&](const char* angle) {
    return json(mount.at(angle).get<double>() * 180.0 / std::numbers::pi).dump();
  };
  Words words = {"--calib",         run.at("calibration"),
                 "--mount",         "given",
                 "--camera-height", mount.at("height_m").dump(),
                 "--camera-pitch",  degrees("pitch_rad"),
                 "--camera-roll",   degrees("roll_rad"),
                 "--preset",        run.at("preset"),
                 "--model",         run.at("people_model"),
                 "--seed",          record.at("seed").dump(),
                 "--json",          "-"};
  for (const auto& options : {run.value("input", json::object()), run.at("options")})
    for (const auto& [name, value] : options.items()) {
      words.push_back("--" + name);
      if (name != "raw" && name != "resized") words.push_back(text_of(value));
    }
  return words;
}

struct Record : ::testing::Test {
  Record() { write_street(folder.path()); }
  Records records(Words words, const Words& more) const {
    words.insert(words.end(), more.begin(), more.end());
    const RunResult result = run_flies(folder.path(), words);
    EXPECT_EQ(result.status, 0) << result.err;
    Records found;
    for (const auto& line : lines(result.out)) found.push_back(json::parse(line));
    return found;
  }
  static json found_in(const Records& records) {
    json all = json::array();
    for (const auto& record : records) {
      json found = record;
      for (const char* key : {"run", "diagnosis", "stage_ms", "preset"}) found.erase(key);
      all.push_back(found);
    }
    return all;
  }
  TestFolder folder;
};

/// The right image of the street, `rows_px` lower.
cv::Mat low_right(double rows_px) {
  cv::Mat low;
  cv::warpAffine(street_pair().right, low, cv::Matx23d(1, 0, 0, 0, 1, rows_px), street_pair().right.size(),
                 cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return low;
}

TEST_F(Record, OfDetectMakesItsRunAgain) {
  cv::Mat both;
  cv::hconcat(street_pair().left, low_right(2.0), both);
  write_image(folder.path() / "both.png", both);
  const Words plain = {"detect", "both.png", "--split", "side", "--calib", "calib.txt", "--json", "-"};
  const Records first =
      records(plain, {"--preset", "handheld", "--evolve.flies", "700", "--seed", "7", "--cameras", "0,1", "--baseline",
                      "0.45", "--calib-size", "320,240", "--camera-pitch", "9", "--disparity-shift", "-0.25"});
  ASSERT_EQ(first.size(), 1U);
  const json& run = first[0].at("run");
  const json input = {
      {"split", "side"}, {"cameras", "0,1"}, {"baseline", 0.45}, {"disparity-shift", -0.25}, {"calib-size", "320,240"}};
  EXPECT_EQ(run.at("input"), input);
  EXPECT_EQ(first[0].at("diagnosis").at("mount").at("source"), "road") << "else the mount is only what was given";
  EXPECT_NEAR(run.at("row_correction").at("offset_px").get<double>(), 2.0, 0.2);
  ASSERT_FALSE(first[0].at("obstacles").empty());
  const Records again = records({"detect", first[0].at("left")}, options_of(first[0]));
  EXPECT_EQ(found_in(again), found_in(first));
  EXPECT_EQ(again.at(0).at("run").at("options"), run.at("options"));
  EXPECT_NE(found_in(records(plain, {})).at(0).at("obstacles"), first[0].at("obstacles"));
}

TEST_F(Record, OfTrackMakesItsRunAgain) {
  write_folders(folder.path(), 4, 4);
  const Words plain = {"track", "l", "r", "--calib", "calib.txt", "--rate", "20", "--json", "-"};
  const Records first =
      records(plain, {"--track.gate", "20", "--ego.min_agreeing", "30", "--evolve.flies", "900", "--camera-height",
                      "1.5", "--camera-pitch", "1.3", "--mount", "given", "--self-rectify", "off", "--seed", "3"});
  ASSERT_EQ(first.size(), 4U);
  const json& run = first[0].at("run");
  EXPECT_EQ(run.at("options").at("track.gate"), 20);
  EXPECT_EQ(run.at("mount").at("height_m"), 1.5);
  EXPECT_EQ(run.at("input"), json({{"self-rectify", "off"}}));
  EXPECT_FALSE(run.contains("row_correction"));
  EXPECT_EQ(first[0].at("diagnosis").at("mount").at("source"), "given");
  ASSERT_FALSE(first.back().at("tracks").empty());
  std::string times;
  for (const auto& record : first) times += record.at("time_s").dump() + "\n";
  write_text(folder.path() / "times.txt", times);
  const auto folder_of = [&](const char* side) {
    return std::filesystem::path(first[0].at(side).get<std::string>()).parent_path().string();
  };
  Words words = options_of(first[0]);
  words.insert(words.end(), {"--times", "times.txt"});
  const auto again = records({"track", folder_of("left"), folder_of("right")}, words);
  EXPECT_EQ(found_in(again), found_in(first));
  EXPECT_EQ(again.at(0).at("run").at("options"), run.at("options"));
  EXPECT_NE(found_in(records(plain, {})).at(3).at("tracks"), first[3].at("tracks"));
}

TEST_F(Record, HoldsOptionsThatUndoWhatFitsTheCamera) {
  const Words low = {"detect", "left.png", "right.png", "--calib",         "calib.txt", "--json",
                     "-",      "--mount",  "given",     "--camera-height", "0.5"};
  const json fitted = records(low, {}).at(0).at("run").at("options");
  ASSERT_TRUE(fitted.contains("evolve.flies")) << fitted;
  const json usual = records(low, {"--evolve.flies", "3000"}).at(0).at("run").at("options");
  EXPECT_EQ(usual.at("evolve.flies"), 3000) << "the value of the preset, which is not what would fit the camera";
}

}  // namespace
}  // namespace flies::testing
