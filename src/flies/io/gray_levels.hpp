#pragma once

#include "flies/io/gray_image.hpp"

namespace cv {
class Mat;
}

namespace flies {

/// Grey of an image of 1 to 4 channels (grey, grey with alpha, BGR, BGRA), of its depth.
cv::Mat gray_levels(const cv::Mat& image);

/// The 8 bits of grey levels of 8 or 16, as `load_gray_image` says.
GrayImage image_of_levels(const cv::Mat& levels);

/// Both images of a pair, as `load_pair` says of files. Nothing is held against each other but the levels.
GrayPair pair_of_levels(const cv::Mat& left, const cv::Mat& right);

}  // namespace flies
