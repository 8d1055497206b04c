#include "flies/io/rectifier.hpp"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flies/core/error.hpp"

namespace flies {
namespace {

struct Remap {
  cv::Mat columns, rows;
};

template <std::size_t Size>
cv::Mat matrix(const std::array<double, Size>& values, int rows) {
  return cv::Mat(rows, static_cast<int>(Size) / rows, CV_64F, const_cast<double*>(values.data())).clone();
}

GrayImage apply(const Remap& map, const GrayImage& image) {
  GrayImage result{image.width_px, image.height_px, std::vector<std::uint8_t>(image.pixels.size())};
  const cv::Mat from(image.height_px, image.width_px, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat to(result.height_px, result.width_px, CV_8U, result.pixels.data());
  cv::remap(from, to, map.columns, map.rows, cv::INTER_LINEAR);
  return result;
}

}  // namespace

struct Rectifier::Maps {
  Remap left, right;
};

Rectifier::Rectifier(const RawStereo& raw, const std::string& source) : source_(source) {
  const cv::Size size(raw.width_px, raw.height_px);
  const cv::Mat m1 = matrix(raw.left_intrinsics, 3), m2 = matrix(raw.right_intrinsics, 3);
  const cv::Mat d1(raw.left_distortion, true), d2(raw.right_distortion, true);
  auto maps = std::make_shared<Maps>();
  cv::Mat r1, r2, p1, p2, q;
  try {
    if (raw.is_fisheye) {
      cv::fisheye::stereoRectify(m1, d1, m2, d2, size, matrix(raw.rotation, 3), matrix(raw.translation_m, 3), r1, r2,
                                 p1, p2, q, cv::CALIB_ZERO_DISPARITY, size);
      cv::fisheye::initUndistortRectifyMap(m1, d1, r1, p1, size, CV_16SC2, maps->left.columns, maps->left.rows);
      cv::fisheye::initUndistortRectifyMap(m2, d2, r2, p2, size, CV_16SC2, maps->right.columns, maps->right.rows);
    } else {
      constexpr double kOnlyValidPixels = 0.0;
      cv::stereoRectify(m1, d1, m2, d2, size, matrix(raw.rotation, 3), matrix(raw.translation_m, 3), r1, r2, p1, p2, q,
                        cv::CALIB_ZERO_DISPARITY, kOnlyValidPixels, size);
      cv::initUndistortRectifyMap(m1, d1, r1, p1, size, CV_16SC2, maps->left.columns, maps->left.rows);
      cv::initUndistortRectifyMap(m2, d2, r2, p2, size, CV_16SC2, maps->right.columns, maps->right.rows);
    }
  } catch (const cv::Exception& error) {
    throw InputError(source, "M1 D1 M2 D2 R T", fmt::format("no rectification exists ({})", error.err));
  }
  if (p2.at<double>(1, 3) != 0.0)
    throw InputError(source, "T", "the cameras stand one above the other, expected side by side");
  camera_.fx_px = p1.at<double>(0, 0);
  camera_.fy_px = p1.at<double>(1, 1);
  camera_.cx_px = p1.at<double>(0, 2);
  camera_.cx_right_px = p2.at<double>(0, 2);
  camera_.cy_px = p1.at<double>(1, 2);
  camera_.baseline_m = -p2.at<double>(0, 3) / p2.at<double>(0, 0);
  camera_.width_px = raw.width_px;
  camera_.height_px = raw.height_px;
  maps_ = std::move(maps);
}

GrayPair Rectifier::rectify(const GrayPair& raw_pair) const {
  check_camera_fits(camera_, raw_pair.left.width_px, raw_pair.left.height_px, source_);
  check_camera_fits(camera_, raw_pair.right.width_px, raw_pair.right.height_px, source_);
  return {apply(maps_->left, raw_pair.left), apply(maps_->right, raw_pair.right), raw_pair.bit_depth};
}

}  // namespace flies
