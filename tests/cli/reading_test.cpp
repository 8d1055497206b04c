// Images as people have them: both in one file, mosaics of colour cameras.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "flies/core/quantile.hpp"
#include "run_flies.hpp"
#include "street_pair.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::Lt;
using ::testing::Not;
using Words = std::vector<std::string>;

struct Reading : ::testing::Test {
  Reading() {
    write_street(folder.path());
    cv::Mat both;
    cv::hconcat(street_pair().left, street_pair().right, both);
    fs::create_directory(folder.path() / "both");
    for (const char* name : {"0.png", "1.png"}) cv::imwrite((folder.path() / "both" / name).string(), both);
    for (const auto& [name, image] :
         {std::pair("ml.png", street_pair().left), std::pair("mr.png", street_pair().right)})
      cv::imwrite((folder.path() / name).string(), reddish_mosaic(image));
  }
  /// A reddish scene behind a pattern rggb.
  static cv::Mat reddish_mosaic(const cv::Mat& gray) {
    cv::Mat mosaic = gray.clone();
    for (int v = 0; v < gray.rows; ++v)
      for (int u = 0; u < gray.cols; ++u)
        if (u % 2 == 1 || v % 2 == 1)
          mosaic.at<std::uint8_t>(v, u) =
              static_cast<std::uint8_t>(gray.at<std::uint8_t>(v, u) * (u % 2 == v % 2 ? 2 : 3) / 5);
    return mosaic;
  }
  RunResult run(const std::string& command, const Words& more) const {
    Words words = {command, "--calib", "calib.txt", "--camera-height", "1.65", "--camera-pitch", "0"};
    words.insert(words.end(), more.begin(), more.end());
    return run_flies(folder.path(), words);
  }
  TestFolder folder;
};

/// The range of the obstacle that is nearest to this one; 0 where there is none.
double range_near(const json& obstacles, const json& one) {
  double best = 1.0, range_m = 0.0;  // metres
  for (const auto& other : obstacles) {
    const double apart = std::hypot(other.at("x_m").get<double>() - one.at("x_m").get<double>(),
                                    other.at("y_m").get<double>() - one.at("y_m").get<double>());
    if (apart >= best) continue;
    best = apart;
    range_m = other.at("range_m").get<double>();
  }
  return range_m;
}

TEST_F(Reading, ImagesResizedByTwoScalesHaveTheRangesOfTheWholeOnes) {
  constexpr int kPairs = 3;
  ASSERT_EQ(run_flies(folder.path(), {"synth", "street", "--seed", "3", "--frames", std::to_string(kPairs)}).status, 0);
  for (const std::string side : {"left", "right"}) {
    fs::create_directory(folder.path() / (side + "1024"));
    for (int i = 0; i < kPairs; ++i) {
      const std::string name = fmt::format("{:06}.png", i);
      cv::Mat resized;
      cv::resize(cv::imread((folder.path() / "street" / side / name).string(), cv::IMREAD_GRAYSCALE), resized,
                 {1024, 320}, 0, 0, cv::INTER_AREA);
      cv::imwrite((folder.path() / (side + "1024") / name).string(), resized);
    }
  }
  const auto detect = [&](const std::string& left, const std::string& right, const Words& more) {
    Words words = {"detect", left, right, "--calib", "street/calib.yaml", "--json", "-"};
    words.insert(words.end(), more.begin(), more.end());
    return run_flies(folder.path(), words);
  };
  const RunResult refused = detect("left1024", "right1024", {});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("0.824 horizontally and 0.853 vertically (then give --resized)"));
  const RunResult resized = detect("left1024", "right1024", {"--resized"});
  ASSERT_EQ(resized.status, 0) << resized.err;
  const auto whole = lines(detect("street/left", "street/right", {}).out), found = lines(resized.out);
  ASSERT_EQ(whole.size(), found.size());
  constexpr double kNear_m = 15.0;  // farther away the lost pixels cost more than the scales could
  std::size_t near = 0;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const json of_whole = json::parse(whole[i]), of_resized = json::parse(found[i]);
    for (const auto& obstacle : of_whole.at("obstacles")) {
      const double range_m = obstacle.at("range_m").get<double>();
      if (range_m > kNear_m) continue;
      ++near;
      if (const double other_m = range_near(of_resized.at("obstacles"), obstacle); other_m > 0.0)
        ratios.push_back(other_m / range_m);
    }
  }
  EXPECT_GE(near, 9U);
  ASSERT_GE(10 * ratios.size(), 8 * near);
  // Which parts of a thing are found differs a little, more so than its surface; one scale for both axes would put all
  // of them 3 % off.
  constexpr double kShare = 0.01, kOfOneThing = 0.06;
  EXPECT_NEAR(median(ratios).value(), 1.0, kShare);
  EXPECT_THAT(ratios, Each(AllOf(Gt(1.0 - kOfOneThing), Lt(1.0 + kOfOneThing))));
}

TEST_F(Reading, OneFileOfBothImagesIsAsGoodAsTwo) {
  const RunResult two = run("detect", {"left.png", "right.png", "--json", "-"}),
                  one = run("detect", {"both/0.png", "--split", "side", "--json", "-"});
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_EQ(json::parse(one.out).at("obstacles"), json::parse(two.out).at("obstacles"));
  EXPECT_THAT(run("check", {"both/0.png", "--split", "side-by-side"}).out, HasSubstr("looks right"));
}

TEST_F(Reading, AFolderOfSuchFilesIsARun) {
  const RunResult found = run("detect", {"both", "--split", "side", "--json", "-"});
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_EQ(lines(found.out).size(), 2U);
  for (const Words& more : {Words{"--json", "-"}, Words{"--json", "-", "--rate", "5"}}) {
    Words words = {"both", "--split", "lr"};
    words.insert(words.end(), more.begin(), more.end());
    const RunResult tracked = run("track", words);
    EXPECT_EQ(tracked.status, 0) << tracked.err;
    EXPECT_EQ(lines(tracked.out).size(), 2U);
  }
  const RunResult live = run("live", {"both", "--split", "side", "--every-pair", "--json", "-"});
  EXPECT_EQ(live.status, 0) << live.err;
  EXPECT_EQ(lines(live.out).size(), 2U);
}

TEST_F(Reading, MosaicsAreToldAndMadeGray) {
  const RunResult told = run("check", {"ml.png", "mr.png"});
  EXPECT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("--bayer rggb or bggr"));
  EXPECT_THAT(run("detect", {"ml.png", "mr.png"}).err, HasSubstr("--bayer rggb or bggr"));
  EXPECT_THAT(run("check", {"ml.png", "mr.png", "--bayer", "rggb"}).out, Not(HasSubstr("--bayer")));
  EXPECT_THAT(run("check", {"ml.png", "mr.png", "--bayer", "grbg"}).out, HasSubstr("look like rggb or bggr"));
  EXPECT_THAT(run("check", {"left.png", "right.png"}).out, Not(HasSubstr("--bayer")));
}

TEST_F(Reading, ThatImagesAreTurnedIsTold) {
  using namespace std::string_literals;
  const std::string exif =
      "\xFF\xE1\0\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x03\0\0\0\0\0\0"s;
  for (const auto& [name, image] :
       {std::pair("tl.jpg", street_pair().left), std::pair("tr.jpg", street_pair().right)}) {
    cv::Mat stored;
    cv::rotate(image, stored, cv::ROTATE_180);
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", stored, bytes, {cv::IMWRITE_JPEG_QUALITY, 98});
    const std::string text(bytes.begin(), bytes.end());
    write_text(folder.path() / name, text.substr(0, 2) + exif + text.substr(2));
  }
  const RunResult found = run("check", {"tl.jpg", "tr.jpg"});
  EXPECT_EQ(found.status, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("looks right"));
  EXPECT_THAT(found.err, HasSubstr("images are turned by 180 degrees, as their EXIF orientation says"));
  EXPECT_THAT(run("detect", {"tl.jpg", "tr.jpg"}).err, HasSubstr("turned by 180 degrees"));
  EXPECT_THAT(run("detect", {"left.png", "right.png"}).err, Not(HasSubstr("EXIF")));
  for (const char* command : {"check", "detect"}) {
    const RunResult one_side = run(command, {"left.png", "tr.jpg"});
    EXPECT_THAT(one_side.err, HasSubstr("left.png and tr.jpg differ in their EXIF orientation")) << command;
    const RunResult refused = run(command, {"tr.jpg", "tl.jpg"});  // told before the fault
    EXPECT_THAT(refused.err, HasSubstr("turned by 180 degrees, as their EXIF")) << command;
  }
}

TEST_F(Reading, WordsThatDoNotFitAreRefused) {
  const auto refused = [&](const std::string& command, const Words& words, const std::string& part) {
    const RunResult result = run(command, words);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(part));
    EXPECT_EQ(lines(result.err).size(), 1U) << result.err;
  };
  refused("detect", {"left.png"}, "RIGHT: is missing");
  refused("check", {"left.png"}, "RIGHT: is missing");
  refused("detect", {"left.png", "right.png", "--split", "side"}, "is not needed");
  refused("track", {"both", "both", "--split", "side"}, "is not needed");
  refused("detect", {"left.png", "--split", "down"}, "expected none, side or top");
  refused("detect", {"left.png", "right.png", "--bayer", "rgbg"}, "expected rggb, bggr, grbg or gbrg");
  refused("detect", {"both", "--split", "side", "--pair-by", "time"}, "is for two folders");
  refused("live", {"both", "--bayer", "rgbg"}, "expected rggb, bggr, grbg or gbrg");
}

}  // namespace
}  // namespace flies::testing
