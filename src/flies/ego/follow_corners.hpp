#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/ego/ego_motion.hpp"

/// Not installed.
namespace flies::ego {

/// A corner of the left image with its disparity; pixels of the full image.
struct StereoCorner {
  cv::Point2f left_px;
  float disparity_px = 0.0F;
};

/// One pair, prepared for following.
struct PreparedPair {
  std::vector<cv::Mat> left_pyramid;   ///< with derivatives, as OpenCV builds it
  std::vector<cv::Mat> right_pyramid;  ///< of one level
  int scale = 1;                       ///< of the pyramid's lowest level against the full image
  std::vector<StereoCorner> corners;

  bool empty() const { return left_pyramid.empty(); }
};

/// Finds corners spread over the left image and their disparity.
/// @param min_disparity_px that of infinity
PreparedPair prepare(const RectifiedPair& pair, double min_disparity_px, const EgoOptions& options);

/// Where the corners of `before` are in the left image of `now`; a pixel that is not a number where one was not found.
/// @param guess_px where to look, one a corner
std::vector<cv::Point2f> follow_corners(const PreparedPair& before, const PreparedPair& now,
                                        const std::vector<cv::Point2f>& guess_px);

/// Disparities of pixels of the left image near a guess; not a number where there is none.
std::vector<float> disparities_near(const PreparedPair& pair, const std::vector<cv::Point2f>& left_px,
                                    const std::vector<float>& guess_px);

}  // namespace flies::ego
