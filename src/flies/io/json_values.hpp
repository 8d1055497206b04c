#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "flies/core/results.hpp"

/// How numbers are written to JSON, the same in all outputs; not installed.

namespace flies {

/// @returns `value` with so many decimals, null when it is not finite; never -0
inline nlohmann::ordered_json rounded(double value, int decimals = 6) {
  if (!std::isfinite(value)) return nullptr;
  const double scale = std::pow(10.0, decimals);
  const double result = std::round(value * scale) / scale + 0.0;  // + 0 turns -0 into 0
  return std::isfinite(result) ? result : value;
}

inline nlohmann::ordered_json box_json(const ImageBox& box) {
  constexpr int kDecimals = 2;
  return {{"u_px", rounded(box.u_px, kDecimals)},
          {"v_px", rounded(box.v_px, kDecimals)},
          {"width_px", rounded(box.width_px, kDecimals)},
          {"height_px", rounded(box.height_px, kDecimals)}};
}

}  // namespace flies
