#pragma once

#include <vector>

#include "flies/core/gray_view.hpp"

namespace flies {

/// What the differences of neighbouring pixels say about how an image was made.
struct ImageSteps {
  /// Of the cells of a grid of 20 x 8 that show something, those whose rows differ more from the next one than from the
  /// next but one: 0.03 at most in 134 good pairs, 0.72 and more where every other row is a tenth of a second later.
  double combed_share = 0.0;
  /// The root mean square of the differences of neighbouring columns over that of columns four apart. 0.25 where all
  /// rises evenly, 0.31 and more in 134 good pairs, 0.26 when one of 1242 columns is blurred by 3 px.
  double sharpness = 1.0;

  bool is_combed() const { return combed_share > 0.1; }
  bool is_blurred() const { return sharpness < 0.285; }
};

/// @param image at least 64 x 48 px
ImageSteps measure_steps(const GrayView& image);

/// Member by member the median. @returns what is told of nothing for no images
ImageSteps median_steps(const std::vector<ImageSteps>& images);

}  // namespace flies
