// Images as people have them: both in one file, mosaics of colour cameras.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "run_flies.hpp"
#include "street_pair.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
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
  write_text(folder.path() / "run.mcap", "not read");
  refused("track", {"run.mcap", "--split", "side"}, "a recording says itself");
  refused("live", {"both", "--bayer", "rgbg"}, "expected rggb, bggr, grbg or gbrg");
}

}  // namespace
}  // namespace flies::testing
