#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace flies {

/// A camera and what it was told by.
struct FocalEvidence {
  cv::Mat matrix, lens;
  bool is_fisheye = false;
  std::vector<std::vector<cv::Point3f>> board_m;  ///< a view's corners on the board
  std::vector<cv::Mat> turns, shifts;             ///< of the board in each view
  double corner_deviation_px = 0.0;               ///< of a coordinate
};

/// Standard deviation of the focal length over it, to first order, the poses of all views being as unknown as the
/// camera. OpenCV's own is of no use where a board never leans: its inverse leaves out what cannot be told.
double relative_focal_deviation(const FocalEvidence& evidence);

}  // namespace flies
