#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace cv {
class Mat;
}

namespace flies {

/// Decodes a PNG, JPEG, PNM, TIFF, WebP or BMP file in memory, and turns the image as its EXIF orientation says. Not
/// with OpenCV's imgcodecs, for loading the hundred libraries that it brings along takes longer than all the rest of
/// `flies detect`.
/// @param bytes that `detail::image_file_fault` has nothing against
/// @returns grey or BGR levels of the file's depth, perhaps with alpha; empty when they cannot be decoded
cv::Mat decode_image(std::string_view bytes);

/// Whether a TIFF file holds a second image of the size of the first, which is the one that is decoded.
bool has_second_image(std::string_view bytes);

/// @param image 8 or 16 bits; grey, BGR or BGRA
/// @param is_small compresses harder, which takes more time
std::vector<std::uint8_t> encode_png(const cv::Mat& image, bool is_small = false);

/// @param image 8 bits, grey or BGR
/// @param quality 1 to 100
std::vector<std::uint8_t> encode_jpeg(const cv::Mat& image, int quality);

}  // namespace flies
