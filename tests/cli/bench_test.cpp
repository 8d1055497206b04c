#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "run_flies.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

struct Bench : ::testing::Test {
  Bench() { write_street(folder.path()); }
  TestFolder folder;
};

TEST_F(Bench, MeasuresEveryStageOfBothPresetsOnOneAndTwoThreads) {
  const auto result =
      run_flies(folder.path(), {"bench", "left.png", "right.png", "--calib", "calib.txt", "--camera-height", "1.65",
                                "--runs", "2", "--only-flies", "--json", "-"});
  ASSERT_EQ(result.status, 0) << result.err;
  const json bench = json::parse(result.out);
  EXPECT_EQ(bench.at("width_px"), 320);
  EXPECT_EQ(bench.at("runs"), 2);
  EXPECT_TRUE(bench.at("others").empty());
  EXPECT_TRUE(bench.at("by_flies").empty());
  ASSERT_EQ(bench.at("frames").size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& frame = bench.at("frames").at(i);
    EXPECT_EQ(frame.at("preset"), i < 2 ? "default" : "paper");
    EXPECT_EQ(frame.at("threads"), i % 2 + 1);
    EXPECT_GT(frame.at("evaluations"), 3000);
    double stages_ms = 0.0;
    for (const char* stage : {"road", "evolve", "concentrate", "propose", "classify"})
      stages_ms += frame.at("stage_ms").at(stage).at("quartiles").at(0).get<double>();
    // The lower quartiles of the parts cannot exceed the upper one of the whole.
    EXPECT_GT(frame.at("frame_ms").at("quartiles").at(1), stages_ms);
    EXPECT_GT(frame.at("evolve_and_concentrate_ms").at("median"), 0.0);
  }
}

TEST_F(Bench, PrintsATable) {
  const auto result = run_flies(folder.path(), {"bench", "left.png", "right.png", "--calib", "calib.txt",
                                                "--camera-height", "1.65", "--runs", "1", "--only-flies"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* words : {"left.png, 320 x 240 px, 1 runs", "default, 1 thread,", "paper, 2 threads,", "whole frame"})
    EXPECT_THAT(result.out, HasSubstr(words));
}

TEST_F(Bench, RefusesHalfOfAnInput) {
  const auto refused = [&](const std::vector<std::string>& words, const char* complaint) {
    const auto result = run_flies(folder.path(), words);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(complaint));
    EXPECT_EQ(lines(result.err).size(), 1U);
  };
  refused({"bench", "left.png"}, "RIGHT");
  refused({"bench", "left.png", "right.png"}, "--calib");
  refused({"bench", "--calib", "calib.txt"}, "--calib");
  refused({"bench", "--baseline", "0.5"}, "--baseline: belongs to a LEFT and RIGHT image");
  refused({"bench", "--runs", "0"}, "--runs");
}

}  // namespace
}  // namespace flies::testing
