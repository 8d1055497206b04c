#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "drawn_boards.hpp"
#include "run_flies.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Words = std::vector<std::string>;

const fs::path kOpenCvPairs = "/usr/share/doc/opencv-doc/examples/data";

struct Calibrate : ::testing::Test {
  RunResult calibrate(const Words& more) const {
    Words words = {"calibrate"};
    words.insert(words.end(), more.begin(), more.end());
    return run_flies(folder.path(), words);
  }
  void refused(const Words& words, const std::string& part) const {
    const RunResult result = calibrate(words);
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(lines(result.err).size(), 1U) << result.err;
    EXPECT_THAT(result.err, HasSubstr(part));
    EXPECT_THAT(folder.listing(), Not(Contains("rig.yml")));
  }
  /// The chessboard pairs of Debian's opencv-doc, as two folders and as files that hold both images.
  void write_opencv_pairs() const {
    for (const char* name : {"left", "right", "both"}) fs::create_directory(folder.path() / name);
    for (const auto& file : fs::directory_iterator(kOpenCvPairs)) {
      const std::string name = file.path().filename().string();
      if (!name.starts_with("left") || name.size() != std::string("left01.jpg").size()) continue;
      const std::string number = name.substr(4);
      const fs::path right = kOpenCvPairs / ("right" + number);
      fs::create_symlink(file.path(), folder.path() / "left" / number);
      fs::create_symlink(right, folder.path() / "right" / number);
      cv::Mat both;
      cv::hconcat(cv::imread(file.path().string()), cv::imread(right.string()), both);
      cv::imwrite((folder.path() / "both" / (number + ".png")).string(), both);
    }
  }
  TestFolder folder;
};

TEST_F(Calibrate, PairsOfOpenCvBecomeAFileThatChecksOut) {
  if (!fs::exists(kOpenCvPairs / "left01.jpg"))
    GTEST_SKIP() << "Debian's opencv-doc is not here (scripts/install-deps --checks)";
  write_opencv_pairs();
  const RunResult result = calibrate({"left", "right", "--board", "9x6", "--square", "0.025", "--output", "rig.yml",
                                      "--picture", "coverage.png", "--json", "errors.json"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("field of view"), HasSubstr("at 20 m"), HasSubstr("baseline")));
  const auto errors = nlohmann::json::parse(read_text(folder.path() / "errors.json"));
  EXPECT_LE(errors.at("row_px").get<double>(), 0.3);
  EXPECT_EQ(errors.at("views").at(0).at("corners").size(), 54U);
  EXPECT_GT(cv::imread((folder.path() / "coverage.png").string()).cols, 1280);
  const RunResult calib = run_flies(folder.path(), {"calib", "rig.yml"});
  EXPECT_THAT(calib.out, AllOf(HasSubstr("raw, rectified first"), HasSubstr("640 x 480 px")));
  const RunResult joined =
      calibrate({"both", "--split", "side", "--board", "9x6", "--square", "0.025", "--output", "both.yml"});
  ASSERT_EQ(joined.status, 0) << joined.err;
  EXPECT_EQ(read_text(folder.path() / "both.yml"), read_text(folder.path() / "rig.yml"));
}

TEST_F(Calibrate, AFirstPairOfAnotherSizeCostsThatPair) {
  if (!fs::exists(kOpenCvPairs / "left01.jpg"))
    GTEST_SKIP() << "Debian's opencv-doc is not here (scripts/install-deps --checks)";
  write_opencv_pairs();
  for (const char* side : {"left", "right"}) {
    cv::Mat larger;
    cv::resize(cv::imread((folder.path() / side / "01.jpg").string()), larger, {800, 600});
    fs::remove(folder.path() / side / "01.jpg");
    cv::imwrite((folder.path() / side / "01.jpg").string(), larger);
  }
  const RunResult result = calibrate({"left", "right", "--board", "9x6", "--square", "0.025", "--output", "rig.yml"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("left out: size: found 800 x 600 px, expected 640 x 480 px as most pairs have"));
}

TEST_F(Calibrate, SaysWhyPairsWereLeftOutWhereTooFewAreLeft) {
  if (!fs::exists(kOpenCvPairs / "left01.jpg"))
    GTEST_SKIP() << "Debian's opencv-doc is not here (scripts/install-deps --checks)";
  write_opencv_pairs();
  const Words words = {"left", "right", "--board", "9x6", "--square", "0.025", "--output", "rig.yml"};
  fs::remove(folder.path() / "left" / "01.jpg");  // the link, not what it leads to
  write_text(folder.path() / "left" / "01.jpg", "damaged");
  const auto spoil = [&](const std::string& number) {  // by the same image twice
    fs::remove(folder.path() / "right" / number);
    fs::copy_file(kOpenCvPairs / ("left" + number), folder.path() / "right" / number);
  };
  for (const std::string number : {"02.jpg", "03.jpg", "04.jpg", "05.jpg", "06.jpg", "07.jpg", "08.jpg", "09.jpg"})
    spoil(number);
  refused(words,
          "views: 4 with a board in both images are left, expected at least 5; 0 dropped; 9 pairs were left out "
          "before, most as left/02.jpg: right/02.jpg: pixels: not a pair");
  for (const std::string number : {"11.jpg", "12.jpg", "13.jpg", "14.jpg"}) spoil(number);
  refused(words, "none of 13 pairs shows a board, and most of them cannot be used: right/02.jpg: pixels: not a pair");
}

/// Hides what lies to the left of the corners of the board's second column, as of a board that is held too far out.
void hide_a_column(const fs::path& file) {
  cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  std::vector<cv::Point2f> corners;
  ASSERT_TRUE(cv::findChessboardCornersSB(image, {9, 6}, corners)) << file;
  const bool is_turned = corners[8].x < corners[0].x;
  float right_px = 0.0F;
  for (std::size_t row = 0; row < 6; ++row) right_px = std::max(right_px, corners[9 * row + (is_turned ? 8 : 0)].x);
  image.colRange(0, static_cast<int>(right_px) + 4).setTo(128);
  fs::remove(file);  // the link, not what it leads to
  cv::imwrite(file.string(), image);
}

TEST_F(Calibrate, BoardsSeenInPartCostTheirPairsAlone) {
  if (!fs::exists(kOpenCvPairs / "left01.jpg"))
    GTEST_SKIP() << "Debian's opencv-doc is not here (scripts/install-deps --checks)";
  write_opencv_pairs();
  hide_a_column(folder.path() / "left" / "03.jpg");
  for (const char* name : {"01.jpg", "02.jpg"})
    for (const char* side : {"left", "right"}) {
      fs::remove(folder.path() / side / name);
      fs::copy_file(folder.path() / side / "03.jpg", folder.path() / side / name);
    }
  const RunResult result =
      calibrate({"left", "right", "--board", "9x6", "--square", "0.025", "--output", "rig.yml", "--json", "rig.json"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(read_text(folder.path() / "rig.json"), HasSubstr("part of it is hidden or outside"));
  EXPECT_TRUE(fs::exists(folder.path() / "rig.yml"));
}

TEST_F(Calibrate, ChecksARigWithoutABoard) {
  write_street(folder.path());
  const RunResult fits = calibrate({"left.png", "right.png", "--check", "calib.txt"});
  EXPECT_EQ(fits.status, 0) << fits.err;
  EXPECT_THAT(fits.out, HasSubstr("calib.txt fits the rig"));
  cv::Mat low;
  const cv::Matx23d moved(1, 0, 0, 0, 1, 2.0);
  cv::warpAffine(street_pair().right, low, moved, street_pair().right.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::imwrite((folder.path() / "low.png").string(), low);
  EXPECT_THAT(calibrate({"left.png", "low.png", "--check", "calib.txt"}).out,
              HasSubstr("does not fit the rig any more"));
  const cv::Matx23d sideways(1, 0, 12.0, 0, 1, 0);
  cv::warpAffine(street_pair().right, low, sideways, low.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::imwrite((folder.path() / "aside.png").string(), low);
  const RunResult aside = calibrate({"left.png", "aside.png", "--check", "calib.txt"});
  EXPECT_EQ(aside.status, 0) << aside.err;
  EXPECT_THAT(aside.out, HasSubstr("may not fit the rig: rows lie 0."));
  EXPECT_THAT(aside.out, HasSubstr("beyond infinity"));
}

/// A film in which each of the first nine pairs is held for three pictures.
void write_film(const fs::path& from, const fs::path& film) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(from)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  files.resize(9);
  const cv::Size size = cv::imread(files.front().string()).size();
  cv::VideoWriter writer(film.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0, size);
  for (const auto& file : files) {
    const cv::Mat picture = cv::imread(file.string());
    for (int i = 0; i < 3; ++i) writer.write(picture);
  }
}

TEST_F(Calibrate, TakesViewsWhileABoardIsHeldBeforeLivingCameras) {
  if (!fs::exists(kOpenCvPairs / "left01.jpg"))
    GTEST_SKIP() << "Debian's opencv-doc is not here (scripts/install-deps --checks)";
  write_opencv_pairs();
  write_film(folder.path() / "both", folder.path() / "both.avi");
  const RunResult result =
      calibrate({"both.avi", "--live", "--views", "7", "--board", "9x6", "--square", "0.025", "--output", "rig.yml"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("view 7 taken"), Not(HasSubstr("view 8"))));
  EXPECT_THAT(result.out, HasSubstr("baseline                0.08"));
  EXPECT_THAT(folder.listing(), Contains("rig.yml"));
}

TEST_F(Calibrate, TakesViewsOfPicturesOfTheSizeOfAZed) {
  write_film_of_boards(folder.path() / "zed.avi", {1280, 720});
  const RunResult result = calibrate(
      {"zed.avi", "--live", "--board", "9x6", "--square", "0.05", "--output", "rig.yml", "--json", "errors.json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto calib = run_flies(folder.path(), {"calib", "rig.yml", "--json"});
  const auto camera = nlohmann::json::parse(calib.out);
  EXPECT_EQ(camera.at("width_px"), 1280);
  EXPECT_EQ(camera.at("height_px"), 720);
  constexpr double kBaseline_m = 0.12, kFewViewsOfAFilm = 0.01;
  EXPECT_NEAR(camera.at("baseline_m").get<double>(), kBaseline_m, kFewViewsOfAFilm * kBaseline_m);
}

TEST_F(Calibrate, TellsOnceThatImagesAreMosaics) {
  if (!fs::exists(kOpenCvPairs / "left01.jpg"))
    GTEST_SKIP() << "Debian's opencv-doc is not here (scripts/install-deps --checks)";
  constexpr double kRed = 0.6, kGreen = 0.9, kBlue = 1.0;
  const auto write_mosaic = [&](const std::string& from, const std::string& to) {
    cv::Mat image = cv::imread((kOpenCvPairs / from).string(), cv::IMREAD_GRAYSCALE);
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u) {
        const double share = (u + v) % 2 == 1 ? kGreen : v % 2 == 0 ? kRed : kBlue;
        image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(share * image.at<std::uint8_t>(v, u));
      }
    cv::imwrite((folder.path() / to).string(), image);
  };
  fs::create_directory(folder.path() / "L");
  fs::create_directory(folder.path() / "R");
  for (const std::string number : {"01", "02"}) {
    write_mosaic("left" + number + ".jpg", "L/" + number + ".png");
    write_mosaic("right" + number + ".jpg", "R/" + number + ".png");
  }
  const Words words = {"L", "R", "--board", "9x6", "--square", "0.025", "--output", "rig.yml"};
  const RunResult told = calibrate(words);
  EXPECT_EQ(told.status, 2);  // two views are too few
  EXPECT_THAT(lines(told.err),
              ElementsAre(HasSubstr("L/01.png: the images look like the raw mosaic"), HasSubstr("views")));
  Words with_pattern = words;
  with_pattern.insert(with_pattern.end(), {"--bayer", "rggb"});
  EXPECT_THAT(calibrate(with_pattern).err, Not(HasSubstr("mosaic")));
  with_pattern.back() = "gbrg";
  const RunResult wrong = calibrate(with_pattern);
  EXPECT_THAT(lines(wrong.err), ElementsAre(HasSubstr("L/01.png: --bayer: the green pixels"), HasSubstr("views")));
}

TEST_F(Calibrate, ChecksOutputsBeforeTheWork) {
  write_street(folder.path());  // which has no board
  const auto refused_with = [&](const std::string& option, const std::string& file, const std::string& part) {
    refused({"left.png", "right.png", "--square", "0.025", "--output", "rig.yml", option, file}, part);
  };
  refused_with("--picture", "nowhere/coverage.png", "nowhere/coverage.png");
  refused_with("--picture", "rig.yml", "this file is already the output of --output");
  refused_with("--json", "left.png", "this file is already an input");
  refused({"left.png", "right.png", "--square", "0.025", "--output", "nowhere/rig.yml"}, "nowhere/rig.yml");
}

TEST_F(Calibrate, RefusesWhatCannotBe) {
  write_street(folder.path());
  const Words good = {"left.png", "right.png", "--board", "9x6", "--square", "0.025", "--output", "rig.yml"};
  const auto with = [&](const Words& more) {
    Words words = good;
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  refused(good, "was found in none of 1 pairs");
  refused({"left.png", "right.png", "--board", "9x6", "--square", "0.025"}, "--output");
  refused({"left.png", "right.png", "--board", "9x6", "--output", "rig.yml"}, "--square");
  refused({"left.png", "right.png", "--board", "9by6", "--square", "0.025", "--output", "rig.yml"}, "9by6");
  refused({"left.png", "right.png", "--square", "25", "--output", "rig.yml"}, "not millimetres");
  refused({"left.png", "--square", "0.025", "--output", "rig.yml"}, "RIGHT");
  refused({"no.avi", "--live", "--board", "9x6", "--square", "0.025", "--output", "rig.yml"}, "no.avi: does not exist");
  refused(with({"--views", "8"}), "--live");
  refused(with({"--live", "--size", "640,240"}), "--size: is asked of cameras");
  refused(with({"--live", "--split", "side"}), "is not needed: with --split one source holds both images");
  refused(with({"--live", "--pair-by", "time"}), "--pair-by: is for folders of images");
  refused(with({"--marker", "0.02"}), "--marker: is for --kind charuco or aprilgrid");
  refused(with({"--dictionary", "5x5_50"}), "--dictionary: is for --kind charuco");
  for (const Words& output : {Words{"--output", "rig.yml"}, {"--picture", "p.png"}, {"--json", "r.json"}})
    refused({"left.png", "right.png", "--check", "calib.txt", output[0], output[1]}, "--check");
  refused(with({"--kind", "checkers"}), "expected chessboard");
  refused(with({"--lens", "wide"}), "expected pinhole");
  refused(with({"--split", "diagonal"}), "none, side or top");
  refused(with({"--kind", "charuco", "--marker", "0.02", "--dictionary", "4x4_60"}), "did you mean '4x4_50'?");
  refused(with({"--kind", "charuco", "--marker", "0.02"}), "charuco");  // none there, or no way to find one
}

}  // namespace
}  // namespace flies::testing
