#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string>

namespace flies {

/// Non-owning view of an 8-bit grey image, row-major. The pixels must outlive the view.
/// `u` counts columns to the right and `v` rows downwards, both from 0 at the centre of the top-left pixel.
struct GrayView {
  const std::uint8_t* data = nullptr;
  int width_px = 0;
  int height_px = 0;
  std::ptrdiff_t stride = 0;  ///< bytes from one row to the next, at least `width_px`; to detectors 0 is packed

  const std::uint8_t* row(int v) const {
    assert(v >= 0 && v < height_px);
    return data + static_cast<std::ptrdiff_t>(v) * stride;
  }
  std::uint8_t at(int u, int v) const {
    assert(u >= 0 && u < width_px);
    return row(v)[u];
  }
};

/// A rectified stereo pair: the same scene point lies on the same row in both images.
struct RectifiedPair {
  GrayView left;
  GrayView right;
};

/// Checks what every stage relies on: both images have pixels and the same size.
/// @throws InputError naming `left_name` and `right_name` otherwise
void check_pair(const RectifiedPair& pair, const std::string& left_name = "left image",
                const std::string& right_name = "right image");

}  // namespace flies
