#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "flies/rig/board.hpp"

namespace flies {

/// Whether OpenCV's aruco was there when the module was built.
#ifdef FLIES_HAS_MARKERS
inline constexpr bool kHasMarkers = true;
#else
inline constexpr bool kHasMarkers = false;
#endif

/// Moves points to the saddle between black and white fields within so many pixels.
void refine_corners(const cv::Mat& image, std::vector<cv::Point2f>& points, int half_window_px);

/// The corners of a chessboard, or what else the image shows.
SeenBoard find_chessboard(const cv::Mat& image, const Board& board);

/// The corners of a charuco board or an aprilgrid, or what else the image shows; nothing without aruco.
SeenBoard find_marked_board(const cv::Mat& image, const Board& board);

}  // namespace flies
