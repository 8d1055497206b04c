#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "run_flies.hpp"
#include "spoilt_street.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
using Words = std::vector<std::string>;

constexpr double kRows_px = 3.0;

struct Check : ::testing::Test {
  Check() { write_street(folder.path()); }

  /// Writes low.png: the right image `kRows_px` lower.
  void write_low_right() const {
    cv::Mat low;
    const cv::Matx23d moved(1, 0, 0, 0, 1, kRows_px);
    cv::warpAffine(street_pair().right, low, moved, street_pair().right.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::imwrite((folder.path() / "low.png").string(), low);
  }
  RunResult check(const std::string& right, const Words& more = {}) const {
    Words words = {"check", "left.png",       right, "--calib", "calib.txt", "--camera-height",
                   "1.65",  "--camera-pitch", "0"};
    words.insert(words.end(), more.begin(), more.end());
    return run_flies(folder.path(), words);
  }
  RunResult detect(const std::string& right, const Words& more = {}) const {
    Words words = {"detect", "left.png",       right, "--calib", "calib.txt", "--camera-height",
                   "1.65",   "--camera-pitch", "0",   "--json",  "-"};
    words.insert(words.end(), more.begin(), more.end());
    return run_flies(folder.path(), words);
  }
  /// The good pair with this mount and no other.
  RunResult with_mount(const std::string& command, const Words& mount, const Words& more = {}) const {
    Words words = {command, "left.png", "right.png", "--calib", "calib.txt"};
    words.insert(words.end(), mount.begin(), mount.end());
    words.insert(words.end(), more.begin(), more.end());
    return run_flies(folder.path(), words);
  }
  static bool finds_the_box(const json& record) {
    for (const auto& obstacle : record.at("obstacles"))
      if (std::abs(obstacle.at("x_m").get<double>() - kBoxX_m) < 0.5 &&
          std::abs(obstacle.at("y_m").get<double>() - kBoxY_m) < 0.7)
        return true;
    return false;
  }
  TestFolder folder;
};

TEST_F(Check, SaysThatAGoodPairLooksRight) {
  const RunResult result = check("right.png", {"--picture", "rows.png"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("looks right"));
  const cv::Mat picture = cv::imread((folder.path() / "rows.png").string());
  EXPECT_GE(picture.cols, 640);
  const json record = json::parse(check("right.png", {"--json"}).out);
  EXPECT_TRUE(record.at("looks_right").get<bool>());
  EXPECT_NEAR(record.at("row_offset_px").get<double>(), 0.0, 0.2);
  EXPECT_GT(record.at("matched_share").get<double>(), 0.32);
}

TEST_F(Check, SaysOfASinglePairThatItIsSwappedAndNoMore) {
  cv::imwrite((folder.path() / "left.png").string(), street_pair().right);
  cv::imwrite((folder.path() / "right.png").string(), street_pair().left);
  const std::string out = check("right.png").out;
  EXPECT_THAT(out, HasSubstr("to check:\n  - left.png: left and right seem to be swapped (with right.png)"));
  for (const char* follows : {"check cx", "--camera-height", "are found on the same row"})
    EXPECT_THAT(out, Not(HasSubstr(follows)));
  write_image(folder.path() / "right.png", unrelated_picture());
  EXPECT_THAT(check("right.png").out, HasSubstr("to check:\n  - right.png: not a pair with left.png"));
}

TEST_F(Check, SaysByHowMuchRowsLieApart) {
  write_low_right();
  const RunResult result = check("low.png");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("to check:"));
  EXPECT_THAT(result.out, HasSubstr("--self-rectify"));
  EXPECT_NEAR(json::parse(check("low.png", {"--json"}).out).at("row_offset_px").get<double>(), kRows_px, 0.2);
}

TEST_F(Check, DetectMakesUpForRowsThatLieApartAndSaysSo) {
  write_low_right();
  const RunResult result = detect("low.png");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("this is corrected"));
  const json record = json::parse(result.out);
  EXPECT_TRUE(finds_the_box(record)) << result.out;
  EXPECT_NEAR(record.at("diagnosis").at("corrected_row_offset_px").get<double>(), kRows_px, 0.2);
  EXPECT_NEAR(record.at("diagnosis").at("row_offset_px").get<double>(), 0.0, 0.2);
}

TEST_F(Check, DetectMakesUpForRowsWhateverTheExposure) {
  write_low_right();
  const std::string low = (folder.path() / "low.png").string();
  cv::imwrite(low, cv::imread(low, cv::IMREAD_GRAYSCALE) * 0.7);
  const RunResult result = detect("low.png");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("are exposure and gain of both cameras the same"));
  const json record = json::parse(result.out);
  EXPECT_NEAR(record.at("diagnosis").at("corrected_row_offset_px").get<double>(), kRows_px, 0.2);
}

TEST_F(Check, TellsAZoomOfOneCamera) {
  cv::Mat zoomed;
  const cv::Mat& right = street_pair().right;
  cv::warpAffine(right, zoomed, cv::Matx23d(1.02, 0, -0.01 * right.cols, 0, 1.02, -0.01 * right.rows), right.size(),
                 cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  cv::imwrite((folder.path() / "zoomed.png").string(), zoomed);
  EXPECT_THAT(check("zoomed.png").out, HasSubstr("% larger than the left one"));
  EXPECT_THAT(check("right.png").out, Not(HasSubstr("larger")));
}

TEST_F(Check, DetectSaysOfTheRoadWhatItsOptionsFind) {
  for (const Words& options : {Words{}, Words{"--preset", "robot"}, Words{"--road.x_max_m", "6"}}) {
    const Words with_given = {"--mount", "given"};
    for (const Words& mount : {Words{}, with_given}) {
      Words more = options;
      more.insert(more.end(), mount.begin(), mount.end());
      const RunResult result = detect("right.png", more);
      const json record = json::parse(result.out);
      EXPECT_EQ(record.at("road").at("found"), record.at("diagnosis").at("road_found")) << options.size();
      EXPECT_THAT(result.err, Not(HasSubstr("no road was found")));  // the mount is right
    }
  }
}

TEST_F(Check, DetectLeavesThemOnRequest) {
  write_low_right();
  const RunResult result = detect("low.png", {"--self-rectify", "off"});
  EXPECT_EQ(result.status, 2);  // so far apart that it looks like no pair
  EXPECT_THAT(result.err, HasSubstr("not rectified"));
  const json right = json::parse(detect("right.png", {"--self-rectify", "off"}).out);
  EXPECT_TRUE(right.at("diagnosis").at("corrected_row_offset_px").is_null());
  EXPECT_EQ(detect("low.png", {"--self-rectify", "maybe"}).status, 2);
}

TEST_F(Check, FindsTheCameraThatWasToldWrong) {
  for (const Words& told :
       {Words{"--camera-height", "0.4"}, Words{"--camera-pitch", "12"}, Words{"--camera-roll", "8"}}) {
    const RunResult result = with_mount("detect", told, {"--json", "-"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("below the camera"));
    const json record = json::parse(result.out);
    EXPECT_TRUE(finds_the_box(record)) << result.out;
    const json& mount = record.at("diagnosis").at("mount");
    EXPECT_EQ(mount.at("source"), "road");
    EXPECT_NEAR(mount.at("height_m").get<double>(), 1.65, 0.05);
    EXPECT_NEAR(mount.at("pitch_rad").get<double>(), 0.0, 0.01);
    EXPECT_NEAR(mount.at("roll_rad").get<double>(), 0.0, 0.01);
    EXPECT_THAT(with_mount("check", told).out, HasSubstr("found, not as given"));
  }
}

TEST_F(Check, DoubtsThePrincipalPointWhereTheCameraSeemsToLookDownAndNothingIsFarAway) {
  cv::Mat moved;
  const cv::Mat& right = street_pair().right;
  cv::warpAffine(right, moved, cv::Matx23d(1, 0, -12, 0, 1, 0), right.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::imwrite((folder.path() / "moved.png").string(), moved);
  EXPECT_THAT(check("moved.png").out, HasSubstr("cx of one camera is some 1"));
}

TEST_F(Check, LeavesTheCameraAsGivenOnRequestAndWhereItIsRight) {
  const RunResult wrong = with_mount("detect", {"--camera-height", "0.4", "--mount", "given"}, {"--json", "-"});
  EXPECT_EQ(wrong.status, 0) << wrong.err;
  const json mount = json::parse(wrong.out).at("diagnosis").at("mount");
  EXPECT_EQ(mount.at("source"), "given");
  EXPECT_EQ(mount.at("height_m").get<double>(), 0.4);
  EXPECT_THAT(wrong.err, HasSubstr("no road was found"));
  EXPECT_EQ(json::parse(detect("right.png").out).at("diagnosis").at("mount").at("source"), "given");
  const RunResult unknown = detect("right.png", {"--mount", "found"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("expected auto or given"));
}

TEST_F(Check, PresetsForRoomsAndHandsFindTheBox) {
  for (const char* preset : {"robot", "handheld"}) {
    const json record = json::parse(detect("right.png", {"--preset", preset}).out);
    EXPECT_EQ(record.at("preset"), preset);
    EXPECT_TRUE(finds_the_box(record)) << preset;
    for (const auto& obstacle : record.at("obstacles")) EXPECT_GT(obstacle.at("range_sd_m").get<double>(), 0.0);
  }
}

TEST_F(Check, CalibSaysWhatTheCameraCanDo) {
  const RunResult result = run_flies(folder.path(), {"calib", "calib.txt", "--size", "320,240"});
  EXPECT_THAT(result.out, HasSubstr("range error (1 sd)"));
  EXPECT_THAT(result.out, HasSubstr("smallest thing seen"));
  EXPECT_THAT(result.out, HasSubstr("looked at"));
  const json record = json::parse(run_flies(folder.path(), {"calib", "calib.txt", "--size", "320,240", "--json"}).out);
  EXPECT_NEAR(record.at("range_sd_at_10_m").get<double>(), 10.0 * std::hypot(0.3 * 10.0 / 150.0, 0.015), 1e-6);
}

TEST_F(Check, TellsARigThatHangsUpsideDown) {
  cv::Mat left, right;
  cv::rotate(street_pair().right, left, cv::ROTATE_180);
  cv::rotate(street_pair().left, right, cv::ROTATE_180);
  cv::imwrite((folder.path() / "left.png").string(), left);
  cv::imwrite((folder.path() / "right.png").string(), right);
  EXPECT_THAT(check("right.png").out, HasSubstr("upside down"));
}

TEST_F(Check, TellsALensCapFromAnEmptyRoad) {
  cv::imwrite((folder.path() / "left.png").string(), street_pair().left * 0.02);
  cv::imwrite((folder.path() / "right.png").string(), street_pair().right * 0.02);
  EXPECT_THAT(check("right.png").out, HasSubstr("nearly black"));
  EXPECT_THAT(detect("right.png").err, HasSubstr("nothing seen does not mean that nothing is there"));
}

TEST_F(Check, OfARunDoesNotLookRightWherePairsAreBadOrUnreadable) {
  write_folders(folder.path(), 3, 3);
  const Words words = {"check", "l", "r", "--calib", "calib.txt", "--camera-height", "1.65", "--camera-pitch", "0"};
  EXPECT_THAT(run_flies(folder.path(), words).out,
              HasSubstr("2 of 3 pairs: both images are those of the previous pair"));
  keep_first_bytes(folder.path() / "l" / "2.png", 0.5);
  const RunResult result = run_flies(folder.path(), words);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("1 of 3 pairs cannot be used; the first error: l/2.png"));
  EXPECT_THAT(result.out, ::testing::Not(HasSubstr("looks right")));
}

TEST_F(Check, OfARunStandsAnOddFirstPair) {
  write_folders(folder.path(), 3, 3);
  const Words words = {"check", "l", "r", "--calib", "calib.txt", "--camera-height", "1.65", "--camera-pitch", "0"};
  const auto said = [&] {
    const RunResult result = run_flies(folder.path(), words);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  write_image(folder.path() / "r" / "0.png", street_pair().left);
  EXPECT_THAT(said(), HasSubstr("1 of 3 pairs cannot be used; the first error: r/0.png: pixels: not a pair"));
  keep_first_bytes(folder.path() / "l" / "0.png", 0.5);
  EXPECT_THAT(said(), HasSubstr("1 of 3 pairs cannot be used; the first error: l/0.png"));
  for (const auto& [side, image] : {std::pair("l", street_pair().left), std::pair("r", street_pair().right)}) {
    cv::Mat larger;
    cv::resize(image, larger, {400, 350});
    write_image(folder.path() / side / "0.png", larger);
  }
  EXPECT_THAT(said(), HasSubstr("1 of 3 pairs cannot be used; the first error: l/0.png: image size"));
}

TEST_F(Check, ListsWhatTheCalibrationLeavesInDoubt) {
  write_text(folder.path() / "calib.txt", kitti_calibration(300.0, 160.0, 5.0));
  const RunResult result = check("right.png");
  EXPECT_THAT(result.out, HasSubstr("  - calib.txt: a baseline of 5 m is unlikely"));
  EXPECT_THAT(result.err, Not(HasSubstr("baseline"))) << "once is enough";
  const json record = json::parse(check("right.png", {"--json"}).out);
  EXPECT_FALSE(record.at("looks_right").get<bool>());
  EXPECT_THAT(record.at("notes").dump(), HasSubstr("a baseline of 5 m"));
}

TEST_F(Check, HowAFileIsTakenIsNoDoubt) {
  write_text(folder.path() / "raw.yml",
             "%YAML:1.0\n---\nimage_width: 320\nimage_height: 240\nM1: [300, 0, 160, 0, 300, 110, 0, 0, 1]\n"
             "D1: [0, 0, 0, 0]\nM2: [300, 0, 160, 0, 300, 110, 0, 0, 1]\nD2: [0, 0, 0, 0]\n"
             "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.5, 0, 0]\n");
  for (const auto& [file, more, told] : {std::tuple("calib.txt", Words{}, "no camera height and pitch, assumed"),
                                         std::tuple("calib.txt", Words{"--baseline", "0.5001"}, "0.5001 m as given"),
                                         std::tuple("raw.yml", Words{}, "taken as raw")}) {
    Words words = {"check", "left.png", "right.png", "--calib", file};
    words.insert(words.end(), more.begin(), more.end());
    const RunResult result = run_flies(folder.path(), words);
    EXPECT_THAT(result.out, HasSubstr("looks right")) << file;
    EXPECT_THAT(result.err, HasSubstr(told));
  }
}

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

TEST_F(Check, SaysWhereTheRoadLiesBeforeItSpeaksOfNearThings) {
  cv::Mat left = street_pair().left.clone(), right = street_pair().right.clone();
  const cv::Mat near = unrelated_picture()(cv::Rect(0, 0, 60, 150));
  near.copyTo(left(cv::Rect(220, 80, 60, 150)));
  near.copyTo(right(cv::Rect(120, 80, 60, 150)));
  write_image(folder.path() / "left.png", left);
  write_image(folder.path() / "right.png", right);
  const std::string out = with_mount("check", {"--camera-height", "1.2", "--camera-pitch", "0"}).out;
  EXPECT_THAT(out, ::testing::ContainsRegex("the road lies[^\n]*\n  - something stands nearer")) << out;
}

TEST_F(Check, SaysThatACameraIsCoveredBeforeItDoubtsTheMount) {
  cv::Mat covered = street_pair().right.clone();
  covered.colRange(0, 60).setTo(90);
  write_image(folder.path() / "right.png", covered);
  const std::string out = with_mount("check", {"--camera-height", "1.2", "--camera-pitch", "0"}).out;
  EXPECT_THAT(out, ::testing::ContainsRegex("shows nothing.*\n  - the road lies")) << out;
}

TEST_F(Check, CamerasThatThePathsOfTheImagesContradictAreADoubt) {
  for (const auto& [name, image] : {std::pair("image_0", "left.png"), std::pair("IMAGE_1", "right.png")}) {
    std::filesystem::create_directories(folder.path() / name);
    std::filesystem::copy_file(folder.path() / image, folder.path() / name / "a.png");
  }
  const auto said = [&](const std::string& calib, const Words& more) {
    Words words = {"check", "image_0/a.png", "IMAGE_1/a.png", "--calib", calib};
    words.insert(words.end(), more.begin(), more.end());
    return run_flies(folder.path(), words).out;
  };
  EXPECT_THAT(said("calib.txt", {"--cameras", "2,3"}),
              HasSubstr("  - calib.txt: --cameras 2,3 is used, but the paths of the images name the cameras 0 and 1"));
  EXPECT_THAT(said("calib.txt", {"--cameras", "0,1"}), HasSubstr("looks right"));
  EXPECT_THAT(said("calib.txt", {}), HasSubstr("looks right"));
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

TEST_F(Check, ListsWhatIsOddAboutThePairing) {
  write_folders(folder.path(), 3, 2);
  const RunResult result = run_flies(folder.path(), {"check", "l", "r", "--calib", "calib.txt"});
  EXPECT_THAT(result.out, HasSubstr("  - these images have no partner and are left out: l/2.png"));
  EXPECT_THAT(result.err, Not(HasSubstr("partner")));
}

TEST_F(Check, RefusesWhatDetectRefuses) {
  const RunResult missing = check("nowhere.png");
  EXPECT_EQ(missing.status, 2);
  EXPECT_EQ(lines(missing.err).size(), 1U);
  EXPECT_THAT(missing.err, HasSubstr("nowhere.png"));
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
