#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "flies/pipeline/detector.hpp"

/// A pair that was processed, with what the pictures of it need. Does not own its images.
struct ProcessedFrame {
  flies::RectifiedPair pair;
  flies::StereoCamera camera;
  flies::DetectorOptions options;
  const flies::Detection* detection = nullptr;
  std::uint32_t index = 0;  ///< of the pair in its sequence

  cv::Mat left() const;  ///< shares the pixels of `pair.left`
};

cv::Mat overlay_picture(const ProcessedFrame& frame);
cv::Mat top_view_picture(const ProcessedFrame& frame);
cv::Mat concentrating_picture(const ProcessedFrame& frame);

/// The same flies, spread at random and not evolved, scored by Eq. (1) and by Eq. (2) (paper, figure 2).
cv::Mat fitness_picture(const ProcessedFrame& frame);

/// Histograms of many such flies in the view-angle of the nearest pedestrian, else of the nearest obstacle, else
/// straight ahead (paper, figure 3).
cv::Mat histogram_picture(const ProcessedFrame& frame);
