#pragma once

#include <string_view>

namespace cv {
class Mat;
}

namespace flies::detail {

/// How the pixels of an image file lie, as its EXIF data (JPEG, PNG, WebP) or its directory (TIFF) tell: 1 as they are
/// to be seen; 2 mirrored, 3 upside down, 4 both; 5 to 8 the same of images that lie on their side (EXIF 2.3, tag
/// 0x0112).
/// @returns 1 to 8; 1 where nothing is told
int stored_orientation(std::string_view bytes);

/// The image as it is to be seen. @param orientation 1 to 8
cv::Mat turned(const cv::Mat& stored, int orientation);

}  // namespace flies::detail
