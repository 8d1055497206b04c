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

#include "check_command.hpp"
#include "run_flies.hpp"
#include "spoilt_street.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

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

}  // namespace
}  // namespace flies::testing
