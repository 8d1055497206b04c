#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "flies/train/toy_pictures.hpp"

namespace flies::testing {

/// A picture with one person, and its label in KITTI's text. @param name says by its number what it is kept apart by
inline void write_toy_street(const std::filesystem::path& folder, const std::string& name, int number) {
  constexpr int kPerson_px = 100;
  cv::Mat picture = toy_background(320, 200, 2000 + number);
  const cv::Point middle(60 + number % 8 * 25, 100);
  draw_toy_person(picture, middle, kPerson_px);
  write_picture(folder / "images" / (name + ".png"), picture);
  std::filesystem::create_directories(folder / "label_2");
  std::ofstream(folder / "label_2" / (name + ".txt"))
      << fmt::format("Pedestrian 0 0 0 {} {} {} {} -1 -1 -1 -1000 -1000 -1000 -10\n", middle.x - 16, middle.y - 50,
                     middle.x + 16, middle.y + 50);
}

/// `train` and `pictures` of a data folder, so few that a network learns them in no time.
inline void write_toy_streets(const std::filesystem::path& folder) {
  for (int i = 0; i < 24; ++i) {
    cv::Mat crop = toy_background(64, 128, 1000 + i);
    draw_toy_person(crop, {32 + i % 3 - 1, 64}, 96);
    const char* source = i % 3 == 0 ? "inria" : i % 3 == 1 ? "mit" : "tud";
    write_picture(folder / "train/positives" / source / fmt::format("{}.png", 100 + i), crop);
  }
  for (int i = 0; i < 10; ++i)
    write_picture(folder / "train/negatives" / fmt::format("{}.png", 100 + i), toy_background(240, 200, i));
  for (int i = 0; i < 20; ++i) write_toy_street(folder / "pictures", fmt::format("kitti_{:06}", i), i);
  for (int i = 0; i < 4; ++i) write_toy_street(folder / "pictures/partly", fmt::format("coco_{:06}", 8 + i), 30 + i);
}

}  // namespace flies::testing
