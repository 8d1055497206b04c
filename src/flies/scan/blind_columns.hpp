#pragma once

#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/scan/cell_layout.hpp"

namespace flies {

/// The columns of cells in which nothing can be matched because one of the images shows nothing there but noise: a
/// covered lens, fog, a dead half of a sensor. What the scan says of them is made up.
/// @param row_step rows from one row of a cell to the next
/// @returns one entry a column of `layout`, true where it is blind
std::vector<bool> blind_columns(const RectifiedPair& pair, const CellLayout& layout, int row_step);

/// The columns of cells that show something nearer than is matched, whose true disparity is none of those compared:
/// what the scan says of them is made up, too.
/// @returns one entry a column of `layout`
std::vector<bool> too_near_columns(const RectifiedPair& pair, const CellLayout& layout, const Projection& projection,
                                   const RoadPlane& road);

}  // namespace flies
