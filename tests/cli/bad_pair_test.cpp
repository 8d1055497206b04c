#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <nlohmann/json.hpp>
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

INSTANTIATE_TEST_SUITE_P(Place, OneBadPair, ::testing::Values(0, 1, 2));

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
