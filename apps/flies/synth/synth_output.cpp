#include "synth/synth_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

#include "flies/io/output_file.hpp"

void write_disparity_png(const std::string& path, const flies::PixelTruth& truth) {
  cv::Mat image(truth.height_px, truth.width_px, CV_16UC1);
  for (int v = 0; v < truth.height_px; ++v) {
    for (int u = 0; u < truth.width_px; ++u) {
      const float disparity_px = truth.disparity_px[truth.index(u, v)];
      const bool is_known = std::isfinite(disparity_px) && disparity_px > 0.0F;
      image.at<std::uint16_t>(v, u) =
          is_known ? static_cast<std::uint16_t>(std::clamp(std::lround(disparity_px * 256.0F), 1L, 65535L)) : 0;
    }
  }
  flies::write_png(path, image);
}
