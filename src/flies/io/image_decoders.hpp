#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <string_view>

namespace flies::detail {

/// Larger images than this are a mistake in the file, and would ask for absurd amounts of memory.
constexpr double kMaxPixels = 1 << 30;

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

}  // namespace flies::detail
