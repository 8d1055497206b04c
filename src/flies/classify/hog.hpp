#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "flies/core/gray_view.hpp"
#include "flies/core/results.hpp"

namespace flies {

/// Shape of a histogram of oriented gradients (Dalal and Triggs 2005) over a window.
struct HogGeometry {
  int window_width_px = 48;  ///< windows are resized to this before their features are computed; aspect 1:2
  int window_height_px = 96;
  int block_px = 16;  ///< square blocks of cells, normalised together
  int stride_px = 8;  ///< from one block to the next, both ways
  int cell_px = 8;    ///< square cells; a block holds a whole number of them
  int bins = 9;       ///< unsigned orientations over 180 degrees
  bool gamma = true;  ///< square-root compression of grey levels before the gradients

  bool operator==(const HogGeometry&) const = default;
};

/// Length of the feature vector that this geometry gives, 1980 for the default.
/// The geometry must be consistent: see `check_hog_geometry`.
std::size_t feature_count(const HogGeometry& geometry);

/// Checks that the window is 1:2, that blocks tile it and that cells tile a block.
/// @throws InputError naming `source` and the field
void check_hog_geometry(const HogGeometry& geometry, const std::string& source);

/// Pixels needed around a window, so that the gradients at its edge are real.
inline constexpr int kHogMargin_px = 1;

/// The features of a window that has the model's size already. Thread-safe.
/// @param window   the window with `kHogMargin_px` more on every side: 50 x 98 px for the default geometry
/// @param geometry consistent
/// @param features `feature_count(geometry)` of them are written, each 0 to 1, in the order of `cv::HOGDescriptor`:
///                 blocks by columns, in a block cells by columns, in a cell bins
void hog_features(const GrayView& window, const HogGeometry& geometry, std::span<float> features);

/// Whether a window has something in it: finite, a few pixels at least, not absurdly large, and overlapping the image.
bool is_worth_a_look(const ImageBox& window, const GrayView& image);

/// The features of a window anywhere in an image, as detection computes them: the window is resized to the model's
/// size; where it leaves the image, the border pixels are repeated. Thread-safe. Training uses this.
/// @param window   of any size that `is_worth_a_look`, aspect 1:2
/// @param features as for `hog_features`
void window_features(const GrayView& image, const ImageBox& window, const HogGeometry& geometry,
                     std::span<float> features);

}  // namespace flies
