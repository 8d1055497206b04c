#pragma once

#include <algorithm>

#include "flies/core/results.hpp"

namespace flies {

inline double area_px2(const ImageBox& box) { return box.width_px * box.height_px; }

/// Area that both boxes cover; 0 when they are apart.
inline double intersection_px2(const ImageBox& a, const ImageBox& b) {
  const double width = std::min(a.u_px + a.width_px, b.u_px + b.width_px) - std::max(a.u_px, b.u_px);
  const double height = std::min(a.v_px + a.height_px, b.v_px + b.height_px) - std::max(a.v_px, b.v_px);
  return std::max(width, 0.0) * std::max(height, 0.0);
}

}  // namespace flies
