#include "flies/classify/hog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <vector>

#include "flies/core/error.hpp"

namespace flies {
namespace {

/// Larger windows than this are a mistake in the file, and would ask for absurd amounts of memory.
constexpr int kMaxWindow_px = 1024;
constexpr int kMaxBins = 64;
/// Below this there is nothing to see: resizing would invent all pixels.
constexpr double kMinWindow_px = 4.0;
/// Beyond this many times the image the window holds nothing but repeated border.
constexpr double kMaxWindowPerImage = 8.0;

cv::HOGDescriptor hog_of(const HogGeometry& geometry) {
  constexpr int kAperture = 1;
  constexpr double kSigmaFromBlock = -1.0;
  constexpr double kClip = 0.2;  // Dalal and Triggs' L2-Hys
  return cv::HOGDescriptor({geometry.window_width_px, geometry.window_height_px},
                           {geometry.block_px, geometry.block_px}, {geometry.stride_px, geometry.stride_px},
                           {geometry.cell_px, geometry.cell_px}, geometry.bins, kAperture, kSigmaFromBlock,
                           cv::HOGDescriptor::L2Hys, kClip, geometry.gamma);
}

cv::Mat mat_of(const GrayView& image) {
  return {image.height_px, image.width_px, CV_8UC1, const_cast<std::uint8_t*>(image.data),
          static_cast<std::size_t>(image.stride)};
}

/// The box and its margin, resized so that the box has the model's size.
cv::Mat window_pixels(const cv::Mat& image, const ImageBox& box, const HogGeometry& geometry) {
  const double margin_u_px = kHogMargin_px * box.width_px / geometry.window_width_px;
  const double margin_v_px = kHogMargin_px * box.height_px / geometry.window_height_px;
  const int left = cvFloor(box.u_px - margin_u_px), right = cvCeil(box.u_px + box.width_px + margin_u_px);
  const int top = cvFloor(box.v_px - margin_v_px), bottom = cvCeil(box.v_px + box.height_px + margin_v_px);
  const cv::Rect wanted(left, top, right - left, bottom - top);
  const cv::Rect inside = wanted & cv::Rect({}, image.size());
  cv::Mat crop = image(inside);
  if (inside != wanted)
    cv::copyMakeBorder(image(inside), crop, inside.y - top, bottom - inside.br().y, inside.x - left,
                       right - inside.br().x, cv::BORDER_REPLICATE);
  cv::Mat pixels;
  cv::resize(crop, pixels,
             {geometry.window_width_px + 2 * kHogMargin_px, geometry.window_height_px + 2 * kHogMargin_px}, 0, 0,
             box.height_px > geometry.window_height_px ? cv::INTER_AREA : cv::INTER_LINEAR);
  return pixels;
}

}  // namespace

std::size_t feature_count(const HogGeometry& geometry) {
  const auto blocks = [&](int window_px) { return (window_px - geometry.block_px) / geometry.stride_px + 1; };
  const int cells = geometry.block_px / geometry.cell_px;
  return static_cast<std::size_t>(blocks(geometry.window_width_px)) *
         static_cast<std::size_t>(blocks(geometry.window_height_px)) *
         static_cast<std::size_t>(cells * cells * geometry.bins);
}

void check_hog_geometry(const HogGeometry& geometry, const std::string& source) {
  const auto require = [&](bool ok, const char* field, int found, const std::string& allowed) {
    if (!ok) throw InputError(source, field, fmt::format("found {}, expected {}", found, allowed));
  };
  const int height = geometry.window_height_px, width = geometry.window_width_px;
  require(height >= 8 && height <= kMaxWindow_px, "hog.window_height_px", height,
          fmt::format("8 to {}", kMaxWindow_px));
  require(2 * width == height, "hog.window_width_px", width,
          fmt::format("half of window_height_px, which is {}", height));
  require(geometry.block_px >= 1 && geometry.block_px <= width, "hog.block_px", geometry.block_px,
          fmt::format("1 to {}", width));
  require(geometry.stride_px >= 1 && (width - geometry.block_px) % geometry.stride_px == 0 &&
              (height - geometry.block_px) % geometry.stride_px == 0,
          "hog.stride_px", geometry.stride_px, "a step that tiles the window with blocks");
  require(geometry.cell_px >= 1 && geometry.block_px % geometry.cell_px == 0, "hog.cell_px", geometry.cell_px,
          fmt::format("a divisor of block_px, which is {}", geometry.block_px));
  require(geometry.bins >= 2 && geometry.bins <= kMaxBins, "hog.bins", geometry.bins, fmt::format("2 to {}", kMaxBins));
}

void hog_features(const GrayView& window, const HogGeometry& geometry, std::span<float> features) {
  assert(window.width_px == geometry.window_width_px + 2 * kHogMargin_px);
  assert(window.height_px == geometry.window_height_px + 2 * kHogMargin_px);
  assert(features.size() == feature_count(geometry));
  std::vector<float> computed;
  hog_of(geometry).compute(mat_of(window), computed, {}, {}, {{kHogMargin_px, kHogMargin_px}});
  std::copy(computed.begin(), computed.end(), features.begin());
}

bool is_worth_a_look(const ImageBox& window, const GrayView& image) {
  const bool finite = std::isfinite(window.u_px) && std::isfinite(window.v_px) && std::isfinite(window.width_px) &&
                      std::isfinite(window.height_px);
  const bool sized = window.width_px >= kMinWindow_px / 2.0 && window.height_px >= kMinWindow_px &&
                     window.width_px <= kMaxWindowPerImage * image.width_px &&
                     window.height_px <= kMaxWindowPerImage * image.height_px;
  return finite && sized && window.u_px < image.width_px && window.v_px < image.height_px &&
         window.u_px + window.width_px > 0.0 && window.v_px + window.height_px > 0.0;
}

void window_features(const GrayView& image, const ImageBox& window, const HogGeometry& geometry,
                     std::span<float> features) {
  assert(is_worth_a_look(window, image));
  const cv::Mat pixels = window_pixels(mat_of(image), window, geometry);
  hog_features({pixels.data, pixels.cols, pixels.rows, static_cast<std::ptrdiff_t>(pixels.step)}, geometry, features);
}

}  // namespace flies
