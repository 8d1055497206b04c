// Runs of `flies check` and `flies detect` on a street.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "run_flies.hpp"
#include "spoilt_street.hpp"
#include "street_pair.hpp"

namespace flies::testing {

using Words = std::vector<std::string>;

inline constexpr double kRows_px = 3.0;

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
  static bool finds_the_box(const nlohmann::json& record) {
    for (const auto& obstacle : record.at("obstacles"))
      if (std::abs(obstacle.at("x_m").get<double>() - kBoxX_m) < 0.5 &&
          std::abs(obstacle.at("y_m").get<double>() - kBoxY_m) < 0.7)
        return true;
    return false;
  }
  TestFolder folder;
};

}  // namespace flies::testing
