#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "run_flies.hpp"
#include "street_pair.hpp"

namespace flies::testing {

using Words = std::vector<std::string>;

inline void write_film(const std::filesystem::path& path, const cv::Mat& picture, int frames) {
  cv::VideoWriter writer(path.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0, picture.size());
  writer.set(cv::VIDEOWRITER_PROP_QUALITY, 98);
  cv::Mat color;
  cv::cvtColor(picture, color, cv::COLOR_GRAY2BGR);
  for (int i = 0; i < frames; ++i) writer.write(color);
}

/// A camera that stands before a street, as films and as folders.
struct LiveCommand : ::testing::Test {
  static constexpr int kFrames = 8;

  LiveCommand() {
    write_street(folder.path());
    const StreetPair& pair = street_pair();
    cv::Mat beside, below;
    cv::hconcat(pair.left, pair.right, beside);
    cv::vconcat(pair.left, pair.right, below);
    write_film(folder.path() / "beside.avi", beside, kFrames);
    write_film(folder.path() / "below.avi", below, kFrames);
    write_film(folder.path() / "l.avi", pair.left, kFrames);
    write_film(folder.path() / "r.avi", pair.right, kFrames);
    for (const char* side : {"left", "right"}) {
      std::filesystem::create_directory(folder.path() / side);
      for (int i = 0; i < 3; ++i)
        std::filesystem::copy_file(folder.path() / (std::string(side) + ".png"),
                                   folder.path() / side / (std::to_string(i) + ".png"));
    }
  }
  RunResult run(Words words, const std::string& prefix = "") const {
    words.insert(words.begin(), "live");
    for (const char* word : {"--camera-height", "1.65", "--camera-pitch", "0"}) words.emplace_back(word);
    return run_flies(folder.path(), words, prefix);
  }
  std::vector<nlohmann::json> records(const Words& words) const {
    const RunResult result = run(words);
    EXPECT_EQ(result.status, 0) << result.err;
    std::vector<nlohmann::json> all;
    for (const auto& line : lines(result.out)) all.push_back(nlohmann::json::parse(line));
    return all;
  }
  TestFolder folder;
};

inline bool sees_the_box(const nlohmann::json& record) {
  return std::ranges::any_of(record.at("tracks"), [](const nlohmann::json& track) {
    return std::abs(track.at("x_m").get<double>() - kBoxX_m) < 0.6 &&
           std::abs(track.at("y_m").get<double>() - kBoxY_m) < 0.6;
  });
}

}  // namespace flies::testing
