#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "street_pair.hpp"

namespace flies::testing {

using Words = std::vector<std::string>;

/// `flies detect` on the street of the test folder, writing out.jsonl and out.png.
inline Words detect(const Words& more = {}, const std::string& left = "left.png",
                    const std::string& right = "right.png") {
  Words words = {"detect",    left,        right,     "--calib",        "calib.txt", "--json",
                 "out.jsonl", "--overlay", "out.png", "--evolve.flies", "300",       "--evolve.generations",
                 "0"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

inline void write_image(const std::filesystem::path& path, const cv::Mat& image) {
  ASSERT_TRUE(cv::imwrite(path.string(), image));
}

inline void keep_first_bytes(const std::filesystem::path& path, double share) {
  std::filesystem::resize_file(
      path, static_cast<std::uintmax_t>(share * static_cast<double>(std::filesystem::file_size(path))));
}

/// Two folders with this many pairs.
inline void write_folders(const std::filesystem::path& folder, int left_count, int right_count) {
  std::filesystem::create_directory(folder / "l");
  std::filesystem::create_directory(folder / "r");
  for (int i = 0; i < left_count; ++i) write_image(folder / "l" / (std::to_string(i) + ".png"), street_pair().left);
  for (int i = 0; i < right_count; ++i) write_image(folder / "r" / (std::to_string(i) + ".png"), street_pair().right);
}

}  // namespace flies::testing
