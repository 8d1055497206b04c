#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "run_flies.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

void write_noise(const fs::path& file, int width_px, int height_px) {
  cv::Mat image(height_px, width_px, CV_8UC1);
  cv::RNG(static_cast<std::uint64_t>(width_px)).fill(image, cv::RNG::UNIFORM, 0, 256);
  fs::create_directories(file.parent_path());
  cv::imwrite(file.string(), image);
}

/// Noise in the right places: numbers do not matter here.
struct EvaluateClassifier : ::testing::Test {
  EvaluateClassifier() {
    for (const std::string name : {"1", "2", "3"}) {
      write_noise(folder.path() / "data/positives/near" / (name + ".png"), 64, 128);
      write_noise(folder.path() / "data/positives/far" / (name + ".png"), 80, 160);
    }
    write_noise(folder.path() / "data/negatives/street.png", 320, 240);
  }
  RunResult run(const Words& more) const {
    Words words = {"evaluate-classifier", "opencv-48x96", "opencv-64x128", "--negatives", "50", "--data", "data"};
    words.insert(words.end(), more.begin(), more.end());
    return run_flies(folder.path(), words);
  }
  TestFolder folder;
};

TEST_F(EvaluateClassifier, PrintsModelsSideBySideAndBySet) {
  const RunResult result = run({"--plot", "det.png", "--html", "report.html"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* word :
       {"data: 6 windows with people, 50 without from 1 pictures", "opencv-48x96", "opencv-64x128",
        "all sets, 6 people", "near, 3 people", "at 0.0001 a window", "calibration error", "microseconds",
        "-: 50 windows without people are too few to tell; 0.0001 a window needs 10000 at least"})
    EXPECT_THAT(result.out, HasSubstr(word));
  EXPECT_FALSE(cv::imread((folder.path() / "det.png").string()).empty());
  const std::string html = read_text(folder.path() / "report.html");
  for (const char* word :
       {"<!DOCTYPE html>", "data:image/png;base64", "opencv-64x128", "share of people over probability", "</html>"})
    EXPECT_THAT(html, HasSubstr(word));
}

TEST_F(EvaluateClassifier, WritesTheDocumentedJson) {
  const RunResult result = run({"--json", "-", "--seed", "7", "--negatives", "100"});
  ASSERT_EQ(result.status, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(report.at("people"), 6);
  EXPECT_EQ(report.at("windows_without_people"), 100);
  EXPECT_EQ(report.at("sampling").at("seed"), 7);
  ASSERT_EQ(report.at("models").size(), 2u);
  const json& rates = report.at("models").at(1).at("rates");
  ASSERT_EQ(rates.size(), 9u) << "three rates of all sets, of far and of near";
  EXPECT_TRUE(rates.at(0).at("set").is_null());
  EXPECT_EQ(rates.at(3).at("set"), "far");
  EXPECT_EQ(rates.at(2).at("false_positives_per_window"), 0.01);
  const json& model = report.at("models").at(1);
  EXPECT_GE(model.at("calibration_error"), 0.0);
  EXPECT_LE(model.at("calibration_error"), 1.0);
  std::size_t windows = 0;
  for (const json& bin : model.at("reliability"))
    windows += bin.at("people").get<std::size_t>() + bin.at("others").get<std::size_t>();
  EXPECT_EQ(windows, 106U);
  for (const char* key : {"detection_rate", "low", "high", "threshold"}) EXPECT_TRUE(rates.at(2).at(key).is_number());
  for (const char* key : {"detection_rate", "threshold"})
    EXPECT_TRUE(rates.at(0).at(key).is_null()) << "too few windows";
  EXPECT_FALSE(rates.at(0).contains("low"));
}

TEST_F(EvaluateClassifier, RepeatsItselfWhateverTheThreads) {
  const auto rates = [&](const char* threads) {
    return json::parse(run({"--json", "-", "--threads", threads}).out).at("models").at(0).at("rates");
  };
  EXPECT_EQ(rates("1"), rates("3"));
}

TEST_F(EvaluateClassifier, NamesWhatIsWrongInOneLine) {
  const auto before = folder.listing();
  const auto fault = [&](const Words& more) {
    const RunResult result = run(more);
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
    EXPECT_EQ(folder.listing(), before) << "nothing may be left behind";
    return result.err;
  };
  EXPECT_THAT(fault({"no-such-model"}), HasSubstr("no-such-model"));
  EXPECT_THAT(fault({"--data", "gone"}), HasSubstr("--data"));
  EXPECT_THAT(fault({"--negatives", "0"}), HasSubstr("negatives"));
  EXPECT_THAT(fault({"--html", "gone/report.html"}), HasSubstr("gone/report.html"));
  EXPECT_THAT(fault({"--plot", "gone/curves.png"}), HasSubstr("gone/curves.png"));
  EXPECT_THAT(fault({"--plot", "r.png", "--html", "r.png"}), HasSubstr("r.png: --plot: this file is already"));
  EXPECT_THAT(fault({"--min_height_px", "500"}), HasSubstr("street.png"));
  fs::remove_all(folder.path() / "data/negatives");
  const RunResult result = run({"--html", "report.html"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("negatives"));
}

}  // namespace
}  // namespace flies::testing
