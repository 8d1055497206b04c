#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <string_view>

namespace flies::detail {

/// Larger images than this are a mistake in the file, and would ask for absurd amounts of memory.
constexpr double kMaxPixels = 1 << 30;

/// Whether a compressed image of this size is a mistake: larger than any, or more pixels than its bytes can hold.
/// Deflate makes at most 1032 bytes of one, and of these each has at most eight pixels.
constexpr bool is_too_large(double width, double height, std::size_t bytes) {
  constexpr double kMostPixelsAByte = 1032.0 * 8.0;
  return width * height > kMaxPixels || width * height > kMostPixelsAByte * static_cast<double>(bytes);
}

/// Bytes of a row of pixels in a Windows bitmap, whose rows end at multiples of four.
constexpr std::size_t row_bytes_of_bmp(int width, int bits_a_pixel) {
  return (static_cast<std::size_t>(width) * static_cast<std::size_t>(bits_a_pixel) + 31) / 32 * 4;
}

// Each as `decode_image`, but the pixels as they are stored (`stored_orientation`).
cv::Mat decode_png(std::string_view bytes);
cv::Mat decode_jpeg(std::string_view bytes);
cv::Mat decode_pnm(std::string_view bytes);
cv::Mat decode_tiff(std::string_view bytes);
cv::Mat decode_webp(std::string_view bytes);
cv::Mat decode_bmp(std::string_view bytes);

bool has_second_tiff_image(std::string_view bytes);

}  // namespace flies::detail
