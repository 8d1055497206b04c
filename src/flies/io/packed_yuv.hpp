#pragma once

#include <optional>
#include <string>

namespace cv {
class Mat;
}

namespace flies::detail {

/// How brightness and colour of a camera's YUV picture stand beside each other, where it was saved as grey levels.
enum class YuvLayout {
  yuyv,    ///< brightness in every other column, from the first on
  uyvy,    ///< brightness in every other column, from the second on
  planes,  ///< brightness in the upper two thirds (NV12, NV21, I420, YV12)
};

/// Whether grey levels are such a picture. Colour is near 128 and jumps against brightness: from column to column 6
/// times as much and more as brightness does along the row, 1.3 times at most in 592 images.
std::optional<YuvLayout> recognise_yuv(const cv::Mat& levels);

/// The brightness alone.
cv::Mat luma_of(const cv::Mat& levels, YuvLayout layout);

/// The sentence on it.
std::string note_on_yuv(YuvLayout layout, int width_px, int height_px);

}  // namespace flies::detail
