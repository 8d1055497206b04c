// Images that do not go with their calibration: raw or rectified, of another size, padded, of cameras that were turned.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "check_command.hpp"
#include "run_flies.hpp"
#include "spoilt_street.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// A rig whose right camera looks higher, so that its raw images show everything `kRaised_px` lower.
constexpr double kRaised_px = 25.0;

struct CheckRaw : Check {
  CheckRaw() {
    cv::Mat raised;
    const cv::Matx23d moved(1, 0, 0, 0, 1, kRaised_px);
    cv::warpAffine(street_pair().right, raised, moved, street_pair().right.size(), cv::INTER_LINEAR,
                   cv::BORDER_REPLICATE);
    write_image(folder.path() / "raw.png", raised);
    write_text(folder.path() / "raw.yml",
               "%YAML:1.0\n---\nimage_width: 320\nimage_height: 240\nM1: [300, 0, 160, 0, 300, 110, 0, 0, 1]\n"
               "D1: [0, 0, 0, 0]\nM2: [300, 0, 160, 0, 300, 135, 0, 0, 1]\nD2: [0, 0, 0, 0]\n"
               "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.5, 0, 0]\n");
  }
  RunResult run(const std::string& command, const std::string& left, const std::string& right) const {
    return run_flies(folder.path(), {command, left, right, "--calib", "raw.yml"});
  }
  /// Of every command: that images are no pair, and why.
  void expect_refused(const std::string& left, const std::string& right, const std::string& why) const {
    const std::string begins = left + ": " + why;
    const RunResult detected = run("detect", left, right);
    EXPECT_EQ(detected.status, 2);
    EXPECT_THAT(lines(detected.err).back(), ::testing::StartsWith("flies: " + begins));
    EXPECT_THAT(run("check", left, right).out, ::testing::ContainsRegex("to check:\n  - " + begins + "[^\n]*\n$"));
    for (const auto& [folder_name, image] : {std::pair("l", left), std::pair("r", right)}) {
      std::filesystem::create_directories(folder.path() / folder_name);
      for (const char* name : {"0.png", "1.png"})
        std::filesystem::copy_file(folder.path() / image, folder.path() / folder_name / name,
                                   std::filesystem::copy_options::overwrite_existing);
    }
    const RunResult tracked = run("track", "l", "r");
    EXPECT_EQ(tracked.status, 2);
    EXPECT_THAT(lines(tracked.err).back(), ::testing::StartsWith("flies: l/0.png: " + why));
    const RunResult lived = run("live", "l", "r");
    EXPECT_EQ(lived.status, 2);
    EXPECT_THAT(lines(lived.err).back(), ::testing::StartsWith("flies: l/0.png: " + why));
    EXPECT_THAT(run("check", "l", "r").out, HasSubstr("to check:\n  - l/0.png: " + why));
  }
};

TEST_F(CheckRaw, ImagesThatAreSwappedAreSaidToBeSwappedByEveryCommand) {
  EXPECT_EQ(run("detect", "left.png", "raw.png").status, 0);
  expect_refused("raw.png", "left.png", "left and right seem to be swapped");
}

TEST_F(CheckRaw, ImagesThatAreRectifiedAlreadyAreSaidToBeRectifiedByEveryCommand) {
  expect_refused("left.png", "right.png", "the images seem to be rectified already");
}

TEST_F(Check, AScaledCalibrationIsADoubtUnlessTheUserSaysThatImagesWereResized) {
  write_text(folder.path() / "large.yaml",
             "fx_px: 600\nfy_px: 600\ncx_px: 320.5\ncx_right_px: 320.5\ncy_px: 220.5\nbaseline_m: 0.5\n"
             "width_px: 640\nheight_px: 480\nheight_m: 1.65\npitch_deg: 0\n");
  const Words words = {"check", "left.png", "right.png", "--calib", "large.yaml"};
  EXPECT_THAT(run_flies(folder.path(), words).out,
              HasSubstr("if they were cropped from larger images instead, ranges are"));
  Words resized = words;
  resized.emplace_back("--resized");
  EXPECT_THAT(run_flies(folder.path(), resized).out, HasSubstr("looks right"));
}

TEST_F(Check, PaddedImagesAreRefusedAlsoWhenSaidToBeResized) {
  write_text(folder.path() / "own.yaml",
             "fx_px: 300\nfy_px: 300\ncx_px: 160\ncx_right_px: 160\ncy_px: 110\nbaseline_m: 0.5\n"
             "width_px: 320\nheight_px: 240\nheight_m: 1.65\npitch_deg: 0\n");
  for (const auto& [name, image] : {std::pair("left", street_pair().left), std::pair("right", street_pair().right)}) {
    cv::Mat padded;
    cv::copyMakeBorder(image, padded, 0, 6, 0, 4, cv::BORDER_CONSTANT, 0);
    write_image(folder.path() / (std::string(name) + "-padded.png"), padded);
  }
  for (const Words& more : {Words{}, Words{"--resized"}}) {
    Words words = {"check", "left-padded.png", "right-padded.png", "--calib", "own.yaml"};
    words.insert(words.end(), more.begin(), more.end());
    const RunResult result = run_flies(folder.path(), words);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr("(left 0, right 4, top 0, bottom 6 px)"));
    EXPECT_THAT(result.err, HasSubstr("What is inside the borders, 320 x 240 px"));
  }

  const RunResult whole = run_flies(folder.path(), {"check", "left.png", "right.png", "--calib", "own.yaml"});
  EXPECT_THAT(whole.out, HasSubstr("looks right")) << whole.err;
}

TEST_F(Check, TellsPicturesThatWereShrunkIntoAFrame) {
  for (const auto& [name, image] : {std::pair("left", street_pair().left), std::pair("right", street_pair().right)}) {
    cv::Mat shrunk, framed;
    cv::resize(image, shrunk, {256, 192}, 0.0, 0.0, cv::INTER_AREA);
    cv::copyMakeBorder(shrunk, framed, 24, 24, 32, 32, cv::BORDER_CONSTANT, 114);
    write_image(folder.path() / (std::string(name) + "-framed.png"), framed);
  }
  const RunResult result =
      run_flies(folder.path(), {"check", "left-framed.png", "right-framed.png", "--calib", "calib.txt"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("straight borders of one grey level (left 32, right 32, top 24, bottom 24 px)"));
  EXPECT_THAT(result.out, HasSubstr("up to 1.25 times too large"));
  EXPECT_THAT(result.out, Not(HasSubstr("looks right")));
}

TEST_F(Check, LeavesOutTheColourOfYuvThatWasSavedAsGrey) {
  for (const auto& [name, image] : {std::pair("left", street_pair().left), std::pair("right", street_pair().right)}) {
    cv::Mat packed;
    cv::merge(std::vector<cv::Mat>{image, cv::Mat(image.size(), CV_8U, cv::Scalar(128))}, packed);
    write_image(folder.path() / (std::string(name) + "-yuyv.png"), packed.reshape(1));
  }
  const RunResult result =
      run_flies(folder.path(), {"detect", "left-yuyv.png", "right-yuyv.png", "--calib", "calib.txt", "--json", "-"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err,
              HasSubstr("(YUYV), saved as if it were grey levels: it is left out, which leaves 320 x 240 px"));
  EXPECT_TRUE(finds_the_box(json::parse(result.out)));
}

TEST(CheckADrawnSequence, TellsCamerasThatAreTurnedAgainstEachOther) {
  const TestFolder folder;
  ASSERT_EQ(run_flies(folder.path(), {"synth", "drive", "--sequence", "--frames", "12", "--width_px", "621",
                                      "--height_px", "188", "--focal_px", "360.75", "--samples_per_side", "1"})
                .status,
            0);
  const std::string right = read_text(folder.path() / "drive" / "calib.yaml");
  const std::string name = "cx_right_px: ";
  const auto at = right.find(name) + name.size();
  const double cx_px = std::stod(right.substr(at));
  const auto told = [&](double moved_px) {
    std::string moved = right;
    moved.replace(at, right.find('\n', at) - at, std::to_string(cx_px + moved_px));
    std::ofstream(folder.path() / "moved.yaml") << moved;
    return run_flies(folder.path(), {"check", "drive/left", "drive/right", "--calib", "moved.yaml", "--json"});
  };
  const json good = json::parse(told(0.0).out), bad = json::parse(told(5.0).out);
  EXPECT_NEAR(good.at("disparity_shift_px").get<double>(), 0.0, 0.5);
  EXPECT_TRUE(good.at("looks_right").get<bool>()) << good.at("notes");
  EXPECT_NEAR(bad.at("disparity_shift_px").get<double>(), -5.0, 0.5);
  EXPECT_THAT(bad.at("notes").dump(), HasSubstr("px too large"));
  const RunResult track = run_flies(folder.path(), {"track", "drive", "--calib", "moved.yaml", "--json", "-"});
  EXPECT_THAT(track.err, HasSubstr("by how corners move from pair to pair, all disparities are"));
  EXPECT_NEAR(json::parse(lines(track.out).back()).at("ego").at("disparity_shift_px").get<double>(), -5.0, 1.0);

  // What is told makes up for it: by option, and by a file that is made with it.
  const auto tracks_of = [&](const Words& camera, bool is_silent) {
    Words words = {"track", "drive", "--json", "-"};
    words.insert(words.end(), camera.begin(), camera.end());
    const RunResult run = run_flies(folder.path(), words);
    if (is_silent) {
      EXPECT_THAT(run.err, Not(HasSubstr("by how corners move")));
    }
    return json::parse(lines(run.out).back()).at("tracks");
  };
  const json as_drawn = tracks_of({"--calib", "drive/calib.yaml"}, true);
  ASSERT_FALSE(as_drawn.empty());
  EXPECT_NE(tracks_of({"--calib", "moved.yaml"}, false), as_drawn);
  EXPECT_EQ(tracks_of({"--calib", "moved.yaml", "--disparity-shift", "-5"}, true), as_drawn);
  ASSERT_EQ(run_flies(folder.path(),
                      {"calib", "moved.yaml", "--disparity-shift", "-5", "--write", "yaml", "--output", "mended.yaml"})
                .status,
            0);
  EXPECT_EQ(tracks_of({"--calib", "mended.yaml"}, true), as_drawn);
}

}  // namespace
}  // namespace flies::testing
