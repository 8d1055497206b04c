#pragma once

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "flies/io/temporary_folder.hpp"

/// Pictures that tests make themselves: people are bright upright figures, the background is lines in other directions.
namespace flies::testing {

/// @param number decides noise and lines
inline cv::Mat toy_background(int width_px, int height_px, int number) {
  cv::RNG random(static_cast<std::uint64_t>(number) + 1);
  cv::Mat picture(height_px, width_px, CV_8U, cv::Scalar(110));
  for (int i = 0; i < 12; ++i) {
    const cv::Scalar level(random.uniform(40, 220));
    const cv::Point to{random.uniform(0, width_px), random.uniform(0, height_px)};
    const cv::Point from{random.uniform(0, width_px), random.uniform(0, height_px)};
    cv::line(picture, from, to, level, 4);
  }
  cv::Mat noise(picture.size(), CV_8U);
  random.fill(noise, cv::RNG::UNIFORM, 0, 20);
  return picture + noise;
}

/// Head, body and two legs between these rows.
inline void draw_toy_person(cv::Mat& picture, cv::Point middle, int height_px) {
  const auto at = [&](double across, double down) {
    return cv::Point(middle.x + cvRound(across * height_px), middle.y + cvRound((down - 0.5) * height_px));
  };
  const int thick = std::max(1, height_px / 12);
  cv::circle(picture, at(0.0, 0.09), height_px / 12, cv::Scalar(235), cv::FILLED);
  cv::rectangle(picture, at(-0.1, 0.2), at(0.1, 0.55), cv::Scalar(235), cv::FILLED);
  cv::line(picture, at(-0.05, 0.55), at(-0.1, 0.97), cv::Scalar(235), thick);
  cv::line(picture, at(0.05, 0.55), at(0.1, 0.97), cv::Scalar(235), thick);
}

inline void write_picture(const std::filesystem::path& path, const cv::Mat& picture) {
  std::filesystem::create_directories(path.parent_path());
  cv::imwrite(path.string(), picture);
}

/// `people/` with crops of 64 x 128 px, the person 96 px high, and `street/` with pictures of 200 x 160 px.
inline void write_toy_data(const std::filesystem::path& folder, int people, int street) {
  for (int i = 0; i < people; ++i) {
    cv::Mat crop = toy_background(64, 128, 1000 + i);
    draw_toy_person(crop, {32 + i % 3 - 1, 64}, 96);
    write_picture(folder / "people" / (std::to_string(100 + i) + ".png"), crop);
  }
  for (int i = 0; i < street; ++i)
    write_picture(folder / "street" / (std::to_string(100 + i) + ".png"), toy_background(200, 160, i));
}

}  // namespace flies::testing
