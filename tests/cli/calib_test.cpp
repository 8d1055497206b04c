#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_flies.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

/// The street's camera as one whose images are raw: the same numbers in Kalibr's words.
constexpr const char* kKalibr =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [300, 300, 160, 110]\n  distortion_model: radtan\n"
    "  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [320, 240]\n"
    "cam1:\n  T_cn_cnm1: [[1, 0, 0, -0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n  camera_model: pinhole\n"
    "  intrinsics: [300, 300, 160, 110]\n  distortion_model: radtan\n  distortion_coeffs: [0, 0, 0, 0]\n"
    "  resolution: [320, 240]\n";

struct Calib : ::testing::Test {
  Calib() { write_text(folder.path() / "camchain.yaml", kKalibr); }
  RunResult calib(const Words& more) const {
    Words words = {"calib"};
    words.insert(words.end(), more.begin(), more.end());
    return run_flies(folder.path(), words);
  }
  TestFolder folder;
};

TEST_F(Calib, WritesRosAsTwoFilesThatReadTheSame) {
  const RunResult written = calib({"camchain.yaml", "--write", "ros", "--output", "left.yaml"});
  EXPECT_EQ(written.status, 0) << written.err;
  EXPECT_THAT(written.err, HasSubstr("--raw"));
  EXPECT_THAT(folder.listing(), ElementsAre("camchain.yaml", "left.yaml", "right.yaml"));
  const RunResult back = calib({"left.yaml", "--raw"});
  EXPECT_THAT(back.out, AllOf(HasSubstr("raw, rectified first"), HasSubstr("baseline                0.5000 m")));
}

TEST_F(Calib, WritesOpenCvToStandardOutput) {
  const RunResult written = calib({"camchain.yaml", "--write", "opencv"});
  EXPECT_EQ(written.status, 0) << written.err;
  EXPECT_THAT(written.out, HasSubstr("T: !!opencv-matrix"));
  write_text(folder.path() / "stereo.yml", written.out);
  EXPECT_THAT(calib({"stereo.yml"}).out, HasSubstr("baseline                0.5000 m"));
}

TEST_F(Calib, TellsWhatAConversionLoses) {
  const std::string camera = "fx_px: 300\ncx_px: 160\ncy_px: 110\nbaseline_m: 0.5\nwidth_px: 320\nheight_px: 240\n";
  write_text(folder.path() / "rolled.yaml", camera + "roll_deg: 5\n");
  for (const char* format : {"opencv", "kitti"})
    EXPECT_THAT(calib({"rolled.yaml", "--write", format}).err,
                HasSubstr("cannot hold height, pitch and roll of the camera: give them again with --camera-roll 5\n"));
  EXPECT_THAT(calib({"camchain.yaml", "--camera-roll", "3", "--camera-height", "1.2", "--write", "opencv"}).err,
              HasSubstr("with --camera-height 1.2 --camera-roll 3\n"));
  EXPECT_EQ(calib({"camchain.yaml", "--write", "opencv"}).err, "");
  EXPECT_THAT(calib({"rolled.yaml", "--write", "yaml"}).err, HasSubstr("height 1.65 m and the pitch 0 degrees"));
  write_text(folder.path() / "whole.yaml", camera + "height_m: 1.2\npitch_deg: 0\n");
  EXPECT_EQ(calib({"whole.yaml", "--write", "yaml"}).err, "");
}

TEST_F(Calib, TellsADoubtThatTheNewFileDoesNotRaise) {
  write_text(folder.path() / "far.yaml", "fx: 300\ncx: 160\ncy: 110\nbaseline: 4\nwidth: 320\nheight: 240\n");
  EXPECT_THAT(calib({"far.yaml", "--write", "kitti"}).err, HasSubstr("baseline"));
}

TEST_F(Calib, RefusesASizeThatTheFileDoesNotFit) {
  const RunResult other = calib({"camchain.yaml", "--size", "300,240"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("the calibration is for 320 x 240 px, the images have 300 x 240 px"));
  EXPECT_THAT(calib({"camchain.yaml", "--size", "160,120"}).out, HasSubstr("160 x 120 px"));
  EXPECT_THAT(calib({"camchain.yaml", "--size", "300,240", "--resized"}).out, HasSubstr("300 x 240 px"));
}

TEST_F(Calib, TakesTheSizeThatAFileIsForWhereItHasNone) {
  write_text(folder.path() / "p.txt", "P0: 500 0 500 0 0 500 250 0 0 0 1 0\nP1: 500 0 500 -250 0 500 250 0 0 0 1 0\n");
  const RunResult result = calib({"p.txt", "--calib-size", "1000,500", "--size", "500,250", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto camera = nlohmann::json::parse(result.out);
  EXPECT_EQ(camera.at("width_px"), 500);
  EXPECT_EQ(camera.at("fx_px"), 250.0);
  const RunResult other = calib({"p.txt", "--calib-size", "1000,500", "--size", "500,300"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("is for 1000 x 500 px, the images have 500 x 300 px"));
}

TEST_F(Calib, WritesItsOwnYamlWithASizeAlone) {
  write_text(folder.path() / "p.txt", "P0: 500 0 500 0 0 500 250 0 0 0 1 0\nP1: 500 0 500 -250 0 500 250 0 0 0 1 0\n");
  const RunResult unsized = calib({"p.txt", "--write", "yaml", "--output", "v.yaml"});
  EXPECT_EQ(unsized.status, 2);
  EXPECT_THAT(unsized.err, HasSubstr("p.txt: image size: is missing"));
  EXPECT_THAT(folder.listing(), ElementsAre("camchain.yaml", "p.txt"));
  EXPECT_EQ(calib({"p.txt", "--size", "1000,500", "--write", "yaml", "--output", "v.yaml"}).status, 0);
  EXPECT_EQ(calib({"v.yaml"}).status, 0);
}

TEST_F(Calib, RefusesConversionsThatCannotBeAndLeavesNothing) {
  const auto refused = [&](const Words& words, const std::string& part) {
    const RunResult result = calib(words);
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(lines(result.err).size(), 1U);
    EXPECT_THAT(result.err, HasSubstr(part));
    EXPECT_THAT(folder.listing(), ElementsAre("camchain.yaml"));
  };
  refused({"camchain.yaml", "--write", "kitti", "--output", "k.txt"}, "raw images");
  refused({"camchain.yaml", "--write", "kity"}, "did you mean 'kitti'?");
  refused({"camchain.yaml", "--disparity-shift", "2", "--write", "opencv"}, "describes raw images");
  refused({"camchain.yaml", "--write", "ros", "--output", "a.yaml"}, "no 'left' in it");
  refused({"camchain.yaml", "--write", "ros"}, "--output left.yaml");
  refused({"camchain.yaml", "--output", "a.yaml"}, "--write");
}

TEST_F(Calib, DetectRectifiesRawImagesAndFindsTheBox) {
  write_street(folder.path());
  const RunResult result = run_flies(folder.path(), {"detect", "left.png", "right.png", "--calib", "camchain.yaml",
                                                     "--camera-height", "1.65", "--camera-pitch", "0", "--json", "-"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("rectified first"));
  bool is_found = false;
  const auto record = nlohmann::json::parse(result.out);
  for (const auto& obstacle : record.at("obstacles"))
    is_found |= std::abs(obstacle.at("x_m").get<double>() - kBoxX_m) < 0.5 &&
                std::abs(obstacle.at("y_m").get<double>() - kBoxY_m) < 0.7;
  EXPECT_TRUE(is_found);
}

TEST_F(Calib, RefusesRawImagesOfAFileThatIsOfRectifiedOnes) {
  write_street(folder.path());
  const RunResult raw = run_flies(folder.path(), {"detect", "left.png", "right.png", "--calib", "calib.txt", "--raw"});
  EXPECT_EQ(raw.status, 2);
  EXPECT_THAT(raw.err, HasSubstr("raw images"));
}

TEST(PairBy, DetectNamesImagesWithoutAPartnerAndGoesOn) {
  const TestFolder folder;
  write_street(folder.path());
  const auto copy = [&](const char* from, const std::string& to) {
    std::filesystem::create_directories((folder.path() / to).parent_path());
    std::filesystem::copy_file(folder.path() / from, folder.path() / to);
  };
  for (const char* name : {"1", "2"}) copy("left.png", std::string("l/") + name + ".png");
  for (const char* name : {"2", "3"}) copy("right.png", std::string("r/") + name + ".png");
  const auto detect = [&](const std::string& by) {
    return run_flies(folder.path(), {"detect", "l", "r", "--calib", "calib.txt", "--json", "-", "--pair-by", by});
  };
  const RunResult by_name = detect("auto");
  EXPECT_EQ(by_name.status, 0) << by_name.err;
  ASSERT_EQ(lines(by_name.out).size(), 1U);
  EXPECT_EQ(nlohmann::json::parse(by_name.out).at("right"), "r/2.png");
  EXPECT_THAT(by_name.err, AllOf(HasSubstr("have no partner"), HasSubstr("l/1.png"), HasSubstr("r/3.png")));
  EXPECT_EQ(lines(detect("order").out).size(), 2U);
  const RunResult unknown = detect("size");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("auto, order, name or time"));
}

}  // namespace
}  // namespace flies::testing
