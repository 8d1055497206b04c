#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/scan/kernels/match_cells.hpp"
#include "flies/scan/scan_options.hpp"

namespace flies {

/// Where the cells of a pair lie, and which disparities they may have.
struct CellLayout {
  int columns = 0, bands = 0;  ///< none when no row shows what a scan is made of
  int bottom_row = 0;
  int nearest_px = 0;  ///< disparity number k is `nearest_px` - k
  int disparities = 0;
  std::vector<int> reach, recede;  ///< of the bands, as in kernels::CellMatching
  std::vector<float> road_px;      ///< of each cell: parallax of the road along its line of sight; may be negative

  std::size_t cell(int band, int column) const {
    return static_cast<std::size_t>(band) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  double middle_u_px(int column) const { return column * kernels::kCellColumns + (kernels::kCellColumns - 1) / 2.0; }
  double middle_v_px(int band, int row_step) const {
    return bottom_row - (band * kernels::kCellRows + (kernels::kCellRows - 1) / 2.0) * row_step;
  }
};

/// Fills `layout`, keeping its memory.
void lay_out_cells(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road,
                   const ScanOptions& options, CellLayout& layout);

/// What a cell shows.
struct CellPoint {
  float disparity_px = 0.0F;  ///< between whole pixels
  float parallax_px = 0.0F;   ///< disparity less that of infinity
  float certainty = 0.0F;     ///< 0..1, how much it is to be believed
};

/// Reads points off matches, one a cell. A cell whose costs are all alike has no certainty, nor has one without
/// contrast.
/// @param gradients of the left image, as `match_cells` leaves them in its memory
void read_points(const CellLayout& layout, const std::vector<kernels::CellMatch>& matches,
                 std::span<const std::uint8_t> gradients, double offset_px, const CellOptions& options,
                 std::vector<CellPoint>& points);

}  // namespace flies
