#pragma once

#include <optional>
#include <string>

#include "flies/io/gray_image.hpp"
#include "flies/io/images.hpp"

namespace cv {
class Mat;
}

namespace flies {

/// Exchanges the bytes of colours of 16 bits where they stand in the other order; those of grey levels are seen to when
/// these become 8 bits. @returns the sentence on it, where it was done
std::optional<std::string> put_bytes_in_order(cv::Mat& image);

/// Grey of an image of 1 to 4 channels (grey, grey with alpha, BGR, BGRA), of its depth.
cv::Mat gray_levels(const cv::Mat& image);

/// The 8 bits of grey levels of 8 or 16, as `load_gray_image` says.
GrayImage image_of_levels(const cv::Mat& levels);

/// Both images of a pair, as `load_pair` says of files. Nothing is held against each other but the levels.
GrayPair pair_of_levels(const cv::Mat& left, const cv::Mat& right);

/// The pair in the halves of one image, as `load_pair` says of files.
/// @param split not `none`
/// @throws InputError naming the image when it cannot be halved, or its halves are too small or the same
GrayPair pair_of_halves(const cv::Mat& levels, Split split, const std::string& name);

}  // namespace flies
