#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "run_flies.hpp"
#include "spoilt_street.hpp"
#include "street_pair.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

/// `flies detect` on folders with three pairs, one of which is spoilt, writing lines and pictures.
class OneBadPair : public ::testing::TestWithParam<int> {
 protected:
  OneBadPair() {
    write_street(folder_.path());
    write_folders(folder_.path(), 3, 3);
  }
  std::string name(const char* side) const { return side + std::string("/") + std::to_string(GetParam()) + ".png"; }
  void expect_the_others(const std::string& named) const {
    const RunResult result = run_flies(folder_.path(), detect({"--camera-height", "1.65"}, "l", "r"));
    EXPECT_EQ(result.status, 2);
    ASSERT_FALSE(lines(result.err).empty());
    const std::string complaint = lines(result.err).back();
    EXPECT_THAT(complaint, ::testing::StartsWith("flies: l: 1 of 3 pairs"));
    EXPECT_THAT(complaint, ::testing::HasSubstr(named));
    const auto records = lines(read_text(folder_.path() / "out.jsonl"));
    ASSERT_EQ(records.size(), 3u);
    for (int i = 0; i < 3; ++i) {
      const auto record = nlohmann::json::parse(records[static_cast<std::size_t>(i)]);
      EXPECT_EQ(record.at("frame"), i);
      EXPECT_EQ(record.contains("error"), i == GetParam());
      EXPECT_EQ(record.at("obstacles").empty(), i == GetParam());
      EXPECT_EQ(fs::exists(folder_.path() / ("out_" + std::to_string(i) + ".png")), i != GetParam());
    }
  }

  const TestFolder folder_;
};

TEST_P(OneBadPair, CostsThatPairWhenItIsDamaged) {
  keep_first_bytes(folder_.path() / name("r"), 0.3);
  expect_the_others(name("r"));
}

TEST_P(OneBadPair, CostsThatPairWhenItIsBlack) {
  write_image(folder_.path() / name("l"), cv::Mat(240, 320, CV_8UC1, cv::Scalar(0)));
  expect_the_others(name("l"));
}

TEST_P(OneBadPair, CostsThatPairWhenItsPicturesAreUnrelated) {
  write_image(folder_.path() / name("r"), unrelated_picture());
  expect_the_others(name("r"));
}

TEST_P(OneBadPair, CostsThatPairWhenItIsALoopOfLinks) {
  const fs::path file = folder_.path() / name("l");
  fs::remove(file);
  fs::create_symlink(file.filename(), file);
  expect_the_others(name("l"));
}

TEST_P(OneBadPair, CostsThatPairWhenItIsOfAnotherSize) {
  for (const char* side : {"l", "r"}) {
    cv::Mat larger;
    cv::resize(side[0] == 'l' ? street_pair().left : street_pair().right, larger, {400, 350});
    write_image(folder_.path() / name(side), larger);
  }
  expect_the_others(name("l"));
}

INSTANTIATE_TEST_SUITE_P(Place, OneBadPair, ::testing::Values(0, 1, 2));

/// `flies track` on the folders `l` and `r` of three pairs.
struct TrackOfFolders : ::testing::Test {
  TrackOfFolders() {
    write_street(folder.path());
    write_folders(folder.path(), 3, 3);
  }
  RunResult track(const std::string& left, const std::string& right) const {
    return run_flies(folder.path(), {"track", left, right, "--calib", "calib.txt", "--rate", "20", "--json", "-"});
  }
  void expect_the_others(const cv::Mat& left, const cv::Mat& right, const std::string& named) const {
    write_image(folder.path() / "l" / "0.png", left);
    write_image(folder.path() / "r" / "0.png", right);
    const RunResult result = track("l", "r");
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(lines(result.err).back(), ::testing::HasSubstr("1 of 3 pairs: could not be used, the others were"));
    ASSERT_THAT(lines(result.out), ::testing::SizeIs(3));
    EXPECT_THAT(nlohmann::json::parse(lines(result.out)[0]).at("error").get<std::string>(),
                ::testing::HasSubstr(named));
    EXPECT_FALSE(nlohmann::json::parse(lines(result.out)[1]).at("obstacles").empty());
  }
  TestFolder folder;
};

TEST_F(TrackOfFolders, AnOddFirstPairCostsNoOther) {
  const auto& [left, right] = street_pair();
  cv::Mat large_left, large_right;
  cv::resize(left, large_left, {400, 350});
  cv::resize(right, large_right, {400, 350});
  expect_the_others(large_left, large_right, "400 x 350");
  expect_the_others(right, left, "swapped");
  expect_the_others(left, left, "identical");
}

TEST_F(TrackOfFolders, ARunWithoutATruePairIsRefused) {
  for (const char* name : {"0.png", "1.png", "2.png"}) write_image(folder.path() / "r" / name, unrelated_picture());
  const RunResult result = track("l", "r");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(lines(result.err).back(), ::testing::StartsWith("flies: r/0.png: not a pair"));
  EXPECT_TRUE(result.out.empty());
}

TEST(BadInputs, ARefusedPairComesWithTheNotesOnItsCalibration) {
  const TestFolder folder;
  write_street(folder.path());
  write_image(folder.path() / "right.png", unrelated_picture());
  const auto told = [&] { return lines(run_flies(folder.path(), detect()).err); };
  EXPECT_EQ(told().size(), 1U) << "the mount explains nothing";
  write_text(folder.path() / "calib.txt", kitti_calibration(300.0, 160.0, 5.0));
  EXPECT_THAT(told(), ::testing::ElementsAre(::testing::HasSubstr("calib.txt: a baseline of 5 m is unlikely"),
                                             ::testing::StartsWith("flies: right.png: not a pair")));
}

TEST(BadInputs, PipesAmongImagesArePassedOver) {
  const TestFolder folder;
  write_street(folder.path());
  write_folders(folder.path(), 1, 1);
  ASSERT_EQ(::mkfifo((folder.path() / "l/zz.png").c_str(), 0600), 0);
  const RunResult result = run_flies(folder.path(), detect({"--camera-height", "1.65"}, "l", "r"));
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST(BadInputs, FoldersWithoutAGoodPairKeepTheLinesThatSayWhy) {
  const TestFolder folder;
  write_street(folder.path());
  write_folders(folder.path(), 2, 2);
  const RunResult result = run_flies(folder.path(), detect({}, "r", "l"));
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, ::testing::HasSubstr("no pair could be used"));
  const auto records = lines(read_text(folder.path() / "out.jsonl"));
  ASSERT_EQ(records.size(), 2u);
  for (const auto& record : records) EXPECT_TRUE(nlohmann::json::parse(record).contains("error")) << record;
}

TEST(BadInputs, FoldersWithoutAReadablePairLeaveNothing) {
  const TestFolder folder;
  write_street(folder.path());
  write_folders(folder.path(), 2, 2);
  const auto before = folder.listing();
  for (const char* pair : {"0.png", "1.png"}) keep_first_bytes(folder.path() / "l" / pair, 0.3);
  EXPECT_EQ(run_flies(folder.path(), detect({}, "l", "r")).status, 2);
  EXPECT_EQ(folder.listing(), before);
}

}  // namespace
}  // namespace flies::testing
