#pragma once

#include <opencv2/core.hpp>
#include <span>

namespace flies::synth {

/// Disparity of every pixel of both images, so that it can be asked what is nearer than a person.
struct Surroundings {
  cv::Mat left, right;  ///< CV_32F, of that image's pixels
  cv::Mat measured;     ///< CV_8U: 255 where the left one was measured, 0 where it was filled in
};

/// Fills gaps along the row with the farther of the two disparities at their ends, as usual for what was hidden, gaps
/// of a few pixels with the nearer one; rows without any are as the next row below. The right image's disparities are
/// those of the left one, moved.
/// @throws InputError when there is not one disparity a pixel
/// @param known,otherwise of every left pixel, NaN where not known; `otherwise` counts where `known` does not
Surroundings surroundings_of(std::span<const float> known, std::span<const float> otherwise, int width_px,
                             int height_px);

}  // namespace flies::synth
