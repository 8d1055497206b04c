#pragma once

/// For who has images as OpenCV's matrices. Includes OpenCV's headers, which nothing else here does; link opencv_core.

#include <opencv2/core/mat.hpp>
#include <string>

#include "flies/core/error.hpp"
#include "flies/core/gray_view.hpp"

namespace flies {

/// A matrix of grey levels as a view, without a copy. Rows may lie apart (regions of a larger matrix).
/// @param image CV_8UC1, not empty; must outlive the view
/// @throws InputError for any other type, and when it is empty
inline GrayView view_of(const cv::Mat& image) {
  if (image.empty()) throw InputError("cv::Mat", "size", "found an empty matrix, expected pixels");
  if (image.dims != 2 || image.type() != CV_8UC1)
    throw InputError("cv::Mat", "type",
                     "found " + std::to_string(image.channels()) + " channels of depth " +
                         std::to_string(image.depth()) + ", expected one of 8 bits (CV_8UC1): grey levels");
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0])};
}

/// The two images of a pair. @throws InputError as `view_of`
inline RectifiedPair view_of(const cv::Mat& left, const cv::Mat& right) { return {view_of(left), view_of(right)}; }

/// A view as a matrix, without a copy. OpenCV has no matrices that cannot be written to: clone it before you do.
/// @param image must outlive the matrix
inline cv::Mat mat_of(const GrayView& image) {
  return {image.height_px, image.width_px, CV_8UC1, const_cast<std::uint8_t*>(image.data),
          static_cast<std::size_t>(image.stride)};
}

}  // namespace flies
