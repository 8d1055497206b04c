// What texts of calibrations are put together from, of a rig that is known.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/toy_rig.hpp"

namespace flies::testing {

/// Error of lengths that a text holds with all their digits, metres.
constexpr double kWritten_m = 1e-6;

inline CalibrationRequest of_raw_images() {
  CalibrationRequest request;
  request.images_are_raw = true;
  return request;
}

inline std::string list(const std::vector<double>& numbers) { return fmt::format("[{}]", fmt::join(numbers, ", ")); }

inline std::vector<double> numbers(const cv::Mat& m) {
  cv::Mat flat = m.clone().reshape(1, 1);
  return std::vector<double>(flat.begin<double>(), flat.end<double>());
}

inline std::string rows(const cv::Mat& m) {
  std::string text;
  for (int i = 0; i < m.rows; ++i) text += (i > 0 ? ", " : "") + list(numbers(m.row(i)));
  return "[" + text + "]";
}

/// As OpenCV's FileStorage writes it to YAML.
/// @param colon behind the key of its numbers
inline std::string opencv_matrix(const std::string& key, const cv::Mat& m, const char* colon = ": ") {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data{}{}\n", key, m.rows, m.cols,
                     colon, list(numbers(m)));
}

/// right_from_left as a 4 x 4 matrix.
inline cv::Mat right_from_left(const ToyRig& rig) {
  cv::Mat pose = cv::Mat::eye(4, 4, CV_64F);
  cv::Mat(rig.r).copyTo(pose(cv::Rect(0, 0, 3, 3)));
  cv::Mat(rig.t).copyTo(pose(cv::Rect(3, 0, 1, 3)));
  return pose;
}

/// Where the left camera stands in the frame of a body.
inline cv::Mat body_from_left() {
  cv::Mat pose = cv::Mat::eye(4, 4, CV_64F);
  cv::Matx33d turn;
  cv::Rodrigues(cv::Vec3d(0.3, -1.2, 0.5), turn);
  cv::Mat(turn).copyTo(pose(cv::Rect(0, 0, 3, 3)));
  cv::Mat(cv::Vec3d(0.2, -0.1, 0.05)).copyTo(pose(cv::Rect(3, 0, 1, 3)));
  return pose;
}

inline cv::Mat body_from_right(const ToyRig& rig) { return body_from_left() * right_from_left(rig).inv(); }

inline std::string focal_and_centre(const cv::Matx33d& m) { return list({m(0, 0), m(1, 1), m(0, 2), m(1, 2)}); }

struct Rectified {
  cv::Mat r1, r2, p1, p2, q;
};

inline Rectified rectified(const ToyRig& rig) {
  Rectified result;
  if (rig.lens == Lens::equidistant)
    cv::fisheye::stereoRectify(rig.m1, rig.d1, rig.m2, rig.d2, {640, 480}, rig.r, rig.t, result.r1, result.r2,
                               result.p1, result.p2, result.q, cv::CALIB_ZERO_DISPARITY);
  else
    cv::stereoRectify(rig.m1, rig.d1, rig.m2, rig.d2, {640, 480}, rig.r, rig.t, result.r1, result.r2, result.p1,
                      result.p2, result.q);
  return result;
}

}  // namespace flies::testing
