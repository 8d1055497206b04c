#pragma once

#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "flies/core/random.hpp"
#include "flies/diagnose/row_error.hpp"

namespace flies {

/// For tests: a smooth random texture as the left image, and as the right one the same shifted to the left by a
/// disparity and lower by `rows_px` in the middle, growing by `slope` from column to column and by `growth` from row to
/// row.
inline GrayPair textured_pair(double disparity_px, double rows_px, double slope, double growth = 0.0) {
  constexpr int kWidth_px = 640, kHeight_px = 240;
  cv::Mat noise(kHeight_px, kWidth_px, CV_8UC1);
  FlyRandom random(5, 0, 0, 0);
  for (auto& level : cv::Mat_<std::uint8_t>(noise)) level = static_cast<std::uint8_t>(random.below(256));
  cv::Mat left, right;
  cv::GaussianBlur(noise, left, {0, 0}, 2.0);
  cv::normalize(left, left, 0, 255, cv::NORM_MINMAX);
  // The right pixel (u, v) shows the left one (u + disparity, v - rows at that place).
  const double middle_u_px = 0.5 * (kWidth_px - 1), middle_v_px = 0.5 * (kHeight_px - 1);
  const cv::Matx23d moved(1.0, 0.0, disparity_px, -slope, 1.0 - growth,
                          -(rows_px - slope * middle_u_px - growth * middle_v_px));
  cv::warpAffine(left, right, moved, left.size(), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT);
  const auto own = [](const cv::Mat& image) {
    return GrayImage{image.cols, image.rows, {image.begin<std::uint8_t>(), image.end<std::uint8_t>()}};
  };
  return {own(left), own(right)};
}

}  // namespace flies
