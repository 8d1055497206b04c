#pragma once

#include <cstddef>
#include <cstdint>

namespace flies::kernels {

/// Cells over an image, with a margin of one cell so that the neighbours of border cells need no test. Cell 0 is in the
/// margin and stands for places outside.
struct Cells {
  Cells(int width_px, int height_px, double cell_width_px, double cell_height_px)
      : per_u(static_cast<float>(1.0 / cell_width_px)),
        per_v(static_cast<float>(1.0 / cell_height_px)),
        max_u_px(static_cast<float>(width_px - 1)),
        max_v_px(static_cast<float>(height_px - 1)),
        columns(static_cast<std::int32_t>(width_px / cell_width_px) + 3),
        rows(static_cast<std::int32_t>(height_px / cell_height_px) + 3) {}

  std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }

  std::uint32_t cell(float u_px, float v_px) const {
    if (!(u_px >= 0.0F && u_px <= max_u_px && v_px >= 0.0F && v_px <= max_v_px)) return 0;
    return static_cast<std::uint32_t>((static_cast<std::int32_t>(v_px * per_v) + 1) * columns +
                                      static_cast<std::int32_t>(u_px * per_u) + 1);
  }

  float per_u, per_v, max_u_px, max_v_px;
  std::int32_t columns, rows;
};

}  // namespace flies::kernels
