#pragma once

#include <vector>

#include "flies/core/gray_view.hpp"

namespace flies {

/// How much single pixels vary by chance, beside how much the scene makes them vary.
struct ImageNoise {
  double noise_gray =
      0.0;  ///< standard deviation of a pixel: in the calmest quarter of the image, so texture adds little
  double contrast_gray =
      0.0;  ///< standard deviation of the pixels of a cell of a grid of 20 x 8, the median of the cells

  /// 6.6 and more in the noisier images of 108 good pairs of streets and rooms (`flies check --json`); infinite without
  /// noise.
  double contrast_to_noise() const;
  /// Whether there is so much that things are missed.
  bool is_much() const;
};

/// With less contrast to noise, things are missed. With normal noise of 4 and 8 grey levels added to the 33 pairs of
/// kitti_stereo2012 it is 6.3 and 3.4 in the middle instead of 22, and the scan is right in 0.75 and 0.58 of the
/// sectors instead of 0.86.
inline constexpr double kLeastContrastToNoise = 5.5;
/// With less noise than this, what has little contrast to it is a plain place.
inline constexpr double kMuchNoise_gray = 2.0;

/// By Immerkær's operator, which neither even nor evenly rising levels answer ("Fast noise variance estimation", 1996).
/// @param image at least 3 x 3 px
ImageNoise measure_noise(const GrayView& image);

/// The middle one by contrast to noise. @returns no noise for no images
ImageNoise median_noise(std::vector<ImageNoise> images);

}  // namespace flies
