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
using ::testing::SizeIs;

/// What a sensor gives before the exposure has settled: a little of the scene below its noise.
cv::Mat dark(const cv::Mat& picture) {
  cv::Mat noise(picture.size(), CV_32F), levels;
  cv::randn(noise, 4.0, 1.5);
  picture.convertTo(levels, CV_32F, 0.01);
  cv::Mat(levels + noise).convertTo(levels, CV_8U);
  return levels;
}

TEST(LiveDiagnosis, CameraThatIsDarkAtFirstFindsItsRoadLater) {
  const TestFolder folder;
  write_street(folder.path());
  constexpr int kDark = 6, kAll = 16;
  for (const auto& [side, picture] : {std::pair{"left", street_pair().left}, std::pair{"right", street_pair().right}}) {
    fs::create_directory(folder.path() / side);
    for (int i = 0; i < kAll; ++i)
      cv::imwrite((folder.path() / side / (std::to_string(100 + i) + ".png")).string(),
                  i < kDark ? dark(picture) : picture);
  }
  const RunResult result = run_flies(folder.path(), {"live", "left", "right", "--rate", "2", "--calib", "calib.txt",
                                                     "--camera-height", "0.6", "--every-pair", "--json", "-"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("the image is nearly black"));
  EXPECT_THAT(result.err, HasSubstr("the road lies 1.6"));
  const auto all = lines(result.out);
  ASSERT_THAT(all, SizeIs(kAll));
  const json first = json::parse(all.front()), last = json::parse(all.back());
  EXPECT_EQ(first.at("diagnosis").at("mount").at("height_m"), 0.6);
  EXPECT_EQ(last.at("diagnosis").at("mount").at("source"), "road");
  EXPECT_NEAR(last.at("diagnosis").at("mount").at("height_m").get<double>(), 1.65, 0.05);
  EXPECT_TRUE(last.at("diagnosis").at("road_found").get<bool>());
  EXPECT_FALSE(last.at("obstacles").empty());
}

}  // namespace
}  // namespace flies::testing
