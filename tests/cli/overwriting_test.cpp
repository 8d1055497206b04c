// No command writes over what it reads, also where it found the file itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "run_flies.hpp"
#include "street_pair.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

using ::testing::HasSubstr;
using Words = std::vector<std::string>;

/// A street for three pairs, as `flies synth --sequence` writes them.
struct Overwriting : ::testing::Test {
  Overwriting() {
    write_street(folder.path());
    for (const char* name : {"left", "right", "truth"}) fs::create_directories(folder.path() / "drv" / name);
    for (const char* name : {"0", "1", "2"}) add_pair(name);
    write_text(folder.path() / "drv/times.txt", "0.0\n0.1\n0.2\n");
    write_text(folder.path() / "drv/calib.yaml", calibration_yaml(street_camera()));
  }
  void add_pair(const std::string& name) const {
    for (const std::string side : {"left", "right"})
      fs::copy_file(folder.path() / (side + ".png"), folder.path() / "drv" / side / (name + ".png"));
    write_text(folder.path() / "drv/truth" / (name + ".json"),
               R"({"time_s": 0.)" + name + R"(, "pose": {"x_m": 0, "y_m": 0, "yaw_rad": 0}, "objects": []})");
  }
  std::map<std::string, std::string> content() const {
    std::map<std::string, std::string> texts;
    for (const auto& name : folder.listing())
      if (fs::is_regular_file(folder.path() / name)) texts[name] = read_text(folder.path() / name);
    return texts;
  }
  void refuses(const Words& words, const std::string& complaint) const {
    const auto before = content();
    const RunResult result = run_flies(folder.path(), words);
    EXPECT_EQ(result.status, 2) << complaint << result.out;
    EXPECT_THAT(lines(result.err).empty() ? "" : lines(result.err).back(), HasSubstr(complaint));
    EXPECT_TRUE(content() == before) << complaint << ": something was written";
  }
  /// The last words are the output's option and file.
  void refuses_input(const Words& words) const {
    refuses(words, words.back() + ": " + words.at(words.size() - 2) + ": this file is already an input");
  }
  TestFolder folder;
};

TEST_F(Overwriting, TrackRefusesItsInputs) {
  for (const char* input : {"drv/calib.yaml", "drv/times.txt", "drv/left/2.png", "drv/right/0.png"})
    refuses_input({"track", "drv", "--json", input});
  refuses_input({"track", "drv", "--kitti", "./drv/left/1.png"});
  refuses_input({"track", "drv/left", "drv/right", "--calib", "calib.txt", "--json", "drv/right/1.png"});
}

TEST_F(Overwriting, AnInputIsRefusedUnderAnyOfItsNames) {
  fs::create_hard_link(folder.path() / "drv/left/2.png", folder.path() / "hard.jsonl");
  fs::create_symlink("drv/left/2.png", folder.path() / "soft.jsonl");
  for (const char* name : {"hard.jsonl", "soft.jsonl", "./drv/../drv/left/2.png"})
    refuses_input({"track", "drv", "--json", name});
  refuses_input({"detect", "drv/left/2.png", "drv/right/2.png", "--calib", "calib.txt", "--json", "hard.jsonl"});
}

TEST_F(Overwriting, TwoOutputsMayNotBeOneFile) {
  write_text(folder.path() / "t.jsonl", "an earlier result\n");
  fs::create_hard_link(folder.path() / "t.jsonl", folder.path() / "t.txt");
  refuses({"track", "drv", "--json", "t.jsonl", "--kitti", "t.txt"},
          "t.txt: --kitti: this file is already the output of --json");
}

TEST_F(Overwriting, LiveRefusesItsInputs) {
  for (const char* input : {"drv/calib.yaml", "drv/times.txt", "drv/left/2.png"})
    refuses_input({"live", "drv", "--every-pair", "--record", input});
  refuses_input({"live", "drv/left", "drv/right", "--calib", "calib.txt", "--every-pair", "--json", "drv/left/1.png"});
}

TEST_F(Overwriting, EvaluateRefusesItsInputs) {
  for (const char* input : {"drv/calib.yaml", "drv/times.txt", "drv/left/2.png", "drv/truth/0.json"})
    refuses_input({"evaluate", "drv", "--seeds", "1", "--json", input});
  refuses_input({"evaluate", "drv", "--seeds", "1", "--plot", "drv/right/0.png"});
}

TEST_F(Overwriting, DetectRefusesTheSecondFileOfACalibration) {
  for (const char* side : {"left", "right"}) write_text(folder.path() / (std::string(side) + ".yaml"), "a camera\n");
  refuses_input({"detect", "left.png", "right.png", "--calib", "left.yaml", "--json", "right.yaml"});
}

TEST_F(Overwriting, OthersRefuseTheirInputs) {
  refuses_input({"check", "left.png", "right.png", "--calib", "calib.txt", "--picture", "right.png"});
  refuses_input(
      {"bench", "left.png", "right.png", "--calib", "calib.txt", "--runs", "1", "--only-flies", "--json", "calib.txt"});
  refuses_input({"calib", "calib.txt", "--size", "320,240", "--write", "yaml", "--output", "calib.txt"});
}

TEST_F(Overwriting, TrainAndItsMeasureRefuseTheirInputs) {
  fs::create_directories(folder.path() / "ec/positives");
  cv::imwrite((folder.path() / "ec/positives/a.png").string(), cv::Mat(128, 64, CV_8UC1, cv::Scalar(9)));
  fs::copy(folder.path() / "drv/left", folder.path() / "ec/negatives");
  refuses_input({"evaluate-classifier", "opencv-48x96", "--data", "ec", "--json", "ec/positives/a.png"});
  refuses_input({"evaluate-classifier", "opencv-48x96", "--data", "ec", "--plot", "ec/negatives/0.png"});
  write_text(folder.path() / "ec/negatives/0.txt", "");
  for (const char* input : {"ec/positives/a.png", "ec/negatives/1.png", "ec/negatives/0.txt"})
    refuses_input({"train", "--positives", "ec/positives", "--negatives", "ec/negatives", "--out", input});
  refuses_input({"train", "--positives", "ec/positives", "--negatives", "ec/negatives", "--stereo-negatives", "drv",
                 "--out", "drv/truth/1.json"});
}

TEST_F(Overwriting, PastingRefusesTheFolderThatItTakesPairsFrom) {
  fs::create_directories(folder.path() / "people");
  cv::Mat crop(128, 64, CV_8UC1, cv::Scalar(120)), mask(128, 64, CV_8UC1, cv::Scalar(0));
  for (int v = 16; v < 112; v += 12) crop.rowRange(v, v + 6).colRange(20, 44).setTo(200);
  mask(cv::Rect(20, 16, 24, 96)).setTo(255);
  cv::imwrite((folder.path() / "people/a.png").string(), crop);
  cv::imwrite((folder.path() / "people/a_mask.png").string(), mask);
  refuses({"synth", "drv", "--force", "--paste", "people", "--onto", "drv"}, "in it is an input");
  fs::create_directories(folder.path() / "nobody");
  refuses({"synth", "drv", "--force", "--paste", "nobody", "--onto", "drv"}, "in it is an input");
  refuses({"synth", "drv", "--paste", "nobody", "--onto", "drv"}, "in it is an input");
  refuses({"synth", "people", "--paste", "nobody", "--onto", "drv"}, "the folder is not empty");
}

TEST_F(Overwriting, AnEarlierResultInTheSameFolderIsWrittenAgain) {
  for (int run = 0; run < 2; ++run) {
    EXPECT_EQ(run_flies(folder.path(), {"track", "drv", "--json", "drv/found.jsonl"}).status, 0);
    EXPECT_EQ(run_flies(folder.path(), {"evaluate", "drv", "--seeds", "1", "--json", "drv/measures.json"}).status, 0);
  }
}

}  // namespace
}  // namespace flies::testing
