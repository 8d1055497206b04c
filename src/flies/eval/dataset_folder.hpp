#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

#include "flies/core/random.hpp"
#include "flies/io/temporary_folder.hpp"

/// Folders of small data sets that tests write.
namespace flies::testing {

inline constexpr const char* kCalibration =
    "fx_px: 60\ncx_px: 40\ncy_px: 30\nbaseline_m: 0.5\nwidth_px: 80\nheight_px: 60\nheight_m: 1.2\n"
    "pitch_deg: 0\n";
inline constexpr const char* kTruth =
    R"({"objects": [{"class": "car", "x_m": 12, "y_m": 1, "length_m": 4, "width_m": 2, "height_m": 1.5}]})";

/// A picture of 80 x 60 random grey levels.
inline std::string picture(std::uint32_t number) {
  std::string pgm = "P5\n80 60\n255\n";
  for (std::uint32_t i = 0; i < 4800; ++i) pgm.push_back(static_cast<char>(philox({i, number, 0, 0}, 1)[0] & 0x7f));
  return pgm;
}

/// A data set in a folder of its own, removed at the end.
struct Folder {
  void add(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories(std::filesystem::path(folder.file(name)).parent_path());
    folder.write(name, content);
  }
  void add_scene(int number) const {
    const std::string name = std::to_string(number);
    add("left/" + name + ".pgm", picture(1));
    add("right/" + name + ".pgm", picture(2));
    add("truth/" + name + ".json", kTruth);
  }
  std::string path(const std::string& name = ".") const { return folder.file(name); }

  TemporaryFolder folder;
};

/// A map of one disparity, which is a wall ahead.
inline cv::Mat wall_map(int width_px = 80) { return {60, width_px, CV_16UC1, cv::Scalar(3 * 256)}; }

}  // namespace flies::testing
