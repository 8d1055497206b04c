// `flies live` with pairs that are swapped, faint, damaged or of different things, and with lines that are read slowly.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "live_command.hpp"
#include "run_flies.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Lt;
using ::testing::Not;
using ::testing::SizeIs;

TEST_F(LiveCommand, TellsPairsThatAreSwappedInTheMiddleOfARun) {
  cv::imwrite((folder.path() / "left" / "2.png").string(), street_pair().right);
  cv::imwrite((folder.path() / "right" / "2.png").string(), street_pair().left);
  const RunResult result =
      run({"left", "right", "--rate", "20", "--calib", "calib.txt", "--every-pair", "--json", "-"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("left/2.png: left and right seem to be swapped"));
  EXPECT_THAT(result.err, HasSubstr("1 of 3 pairs: left and right swapped; the first: left/2.png"));
  EXPECT_THAT(result.err, HasSubstr("2 pairs"));
  EXPECT_THAT(result.err, HasSubstr("0 dropped; no pairs: 1"));
  ASSERT_THAT(lines(result.out), SizeIs(3));
  const json passed_over = json::parse(lines(result.out)[2]);
  EXPECT_EQ(passed_over.at("frame"), 2);
  EXPECT_THAT(passed_over.at("error").get<std::string>(), HasSubstr("left and right seem to be swapped"));
  EXPECT_TRUE(passed_over.at("obstacles").empty());
}

TEST_F(LiveCommand, RefusesPaddedPictures) {
  write_text(folder.path() / "own.yaml",
             "fx_px: 300\nfy_px: 300\ncx_px: 160\ncx_right_px: 160\ncy_px: 110\nbaseline_m: 0.5\n"
             "width_px: 320\nheight_px: 240\nheight_m: 1.65\npitch_deg: 0\n");
  for (const auto& [side, image] : {std::pair("left", street_pair().left), std::pair("right", street_pair().right)})
    for (int i = 0; i < 3; ++i) {
      cv::Mat padded;
      cv::copyMakeBorder(image, padded, 40, 40, 0, 0, cv::BORDER_CONSTANT, 0);
      cv::imwrite((folder.path() / side / (std::to_string(i) + ".png")).string(), padded);
    }
  const RunResult result = run({"left", "right", "--rate", "20", "--calib", "own.yaml", "--resized"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("(left 0, right 0, top 40, bottom 40 px)"));
}

TEST_F(LiveCommand, SwappedPairsDoNotOvertakeWhatIsStillWorkedOn) {
  constexpr int kPairs = 9;
  constexpr std::array kSwapped = {6, 8};  // the first five are waited for
  for (int i = 0; i < kPairs; ++i) {
    const bool is_swapped = std::ranges::find(kSwapped, i) != kSwapped.end();
    const std::string name = std::to_string(i) + ".png";
    cv::imwrite((folder.path() / "left" / name).string(), is_swapped ? street_pair().right : street_pair().left);
    cv::imwrite((folder.path() / "right" / name).string(), is_swapped ? street_pair().left : street_pair().right);
  }
  const RunResult result = run({"left", "right", "--rate", "20", "--calib", "calib.txt", "--threads", "1",
                                "--evolve.generations", "400", "--json", "-"});
  ASSERT_EQ(result.status, 0) << result.err;
  std::vector<std::uint64_t> frames, dropped;
  for (const auto& line : lines(result.out)) {
    const json record = json::parse(line);
    frames.push_back(record.at("frame"));
    dropped.push_back(record.at("live").at("dropped"));
  }
  ASSERT_FALSE(frames.empty());
  EXPECT_TRUE(std::ranges::is_sorted(frames)) << ::testing::PrintToString(frames);
  EXPECT_TRUE(std::ranges::is_sorted(dropped)) << ::testing::PrintToString(dropped);
  EXPECT_EQ(frames.back(), kPairs - 1U);
  EXPECT_THAT(result.err, HasSubstr("; " + std::to_string(kPairs - frames.size()) + " dropped; no pairs: 2"));
}

TEST_F(LiveCommand, FaintFilmIsStretched) {
  cv::Mat beside;
  cv::hconcat(street_pair().left, street_pair().right, beside);
  constexpr double kContrast = 0.2, kLevel = 100.0;
  const double mean = cv::mean(beside)[0];
  beside.convertTo(beside, CV_8U, kContrast, kLevel - kContrast * mean);
  write_film(folder.path() / "faint.avi", beside, 3);
  const RunResult result = run({"faint.avi", "--calib", "calib.txt", "--every-pair", "--json", "-"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("lie in a narrow band"));
  ASSERT_THAT(lines(result.out), SizeIs(3));
  EXPECT_TRUE(sees_the_box(json::parse(lines(result.out).back())));
}

TEST_F(LiveCommand, DamagedPictureIsToldOnceAndLeftOut) {
  write_text(folder.path() / "left" / "1.png", "damaged");
  const RunResult result = run({"left", "right", "--calib", "calib.txt", "--rate", "20", "--every-pair", "--loop",
                                "--pairs", "6", "--json", "-"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(lines(result.out), SizeIs(6));
  const auto told = lines(result.err);
  EXPECT_EQ(std::ranges::count_if(told, [](const auto& line) { return line.find("left/1.png") != line.npos; }), 1);
  EXPECT_THAT(result.err, HasSubstr("broken pictures: "));
}

TEST_F(LiveCommand, UnrelatedPicturesAreRefused) {
  cv::Mat beside;
  cv::hconcat(street_pair().left, unrelated_picture(), beside);
  write_film(folder.path() / "unrelated.avi", beside, 3);
  const RunResult result = run({"unrelated.avi", "--calib", "calib.txt", "--json", "-"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(lines(result.err), SizeIs(1));
}

TEST_F(LiveCommand, SourceThatEndsWithoutAPairIsAFault) {
  for (const char* name : {"0.png", "1.png", "2.png"}) std::ofstream(folder.path() / "left" / name) << "damaged";
  const RunResult result = run({"left", "right", "--calib", "calib.txt", "--every-pair", "--json", "-"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(lines(result.err).back(), HasSubstr("the source ended without a pair; broken pictures: 3"));
}

TEST_F(LiveCommand, APairThatTakesLongHasItsResultHoweverManyComeMeanwhile) {
  constexpr int kPairs = 60;
  const auto all = records({"left", "right", "--loop", "--rate", "500", "--pairs", std::to_string(kPairs), "--calib",
                            "calib.txt", "--evolve.generations", "1000", "--json", "-"});
  std::vector<int> frames;
  for (const json& record : all) frames.push_back(record.at("frame"));
  EXPECT_THAT(frames, Contains(AllOf(Ge(5), Lt(kPairs - 1))));  // the last is worked on when nothing more comes
}

TEST_F(LiveCommand, SlowReaderOfLinesLosesNothingUncounted) {
  const Words words = {"live",   "beside.avi", "--calib", "calib.txt", "--mount", "given",
                       "--loop", "--pairs",    "60",      "--json",    "pipe"};
  const RunResult result = run_flies(folder.path(), words, "mkfifo pipe; (sleep 2; cat > got.jsonl) < pipe &",
                                     "; status=$?; wait; exit $status");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto got = lines(read_text(folder.path() / "got.jsonl"));
  ASSERT_FALSE(got.empty());
  const json last = json::parse(got.back());
  EXPECT_EQ(got.size() + last.at("live").at("dropped").get<std::size_t>(), last.at("frame").get<std::size_t>() + 1);
  EXPECT_THAT(result.err, Not(HasSubstr("left out"))) << "three seconds of pairs may wait";
}

TEST_F(LiveCommand, PatientRunWaitsForASlowReaderOfLines) {
  constexpr std::size_t kPairs = 150;  // more than may wait
  const Words words = {"live",   "beside.avi", "--calib",      "calib.txt", "--mount",
                       "given",  "--loop",     "--every-pair", "--pairs",   std::to_string(kPairs),
                       "--json", "pipe"};
  const RunResult result = run_flies(folder.path(), words, "mkfifo pipe; (sleep 4; cat > got.jsonl) < pipe &",
                                     "; status=$?; wait; exit $status");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(lines(read_text(folder.path() / "got.jsonl")), SizeIs(kPairs));
  EXPECT_THAT(result.err, Not(HasSubstr("left out")));
}

}  // namespace
}  // namespace flies::testing
