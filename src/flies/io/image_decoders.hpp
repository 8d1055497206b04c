#pragma once

#include <opencv2/core/mat.hpp>
#include <string_view>

namespace flies::detail {

/// Larger images than this are a mistake in the file, and would ask for absurd amounts of memory.
constexpr double kMaxPixels = 1 << 30;

// Each as `decode_image`.
cv::Mat decode_png(std::string_view bytes);
cv::Mat decode_jpeg(std::string_view bytes);
cv::Mat decode_pnm(std::string_view bytes);
cv::Mat decode_tiff(std::string_view bytes);

}  // namespace flies::detail
