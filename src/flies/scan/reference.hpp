#pragma once

#include <vector>

#include "flies/scan/kernels/match_cells.hpp"

namespace flies {

/// What kernels::match_cells computes, one cell, one path and one disparity at a time, as the paper on semi-global
/// matching defines it (Hirschmüller 2008, eq. 13, with any larger step at one price). For tests.
std::vector<kernels::CellMatch> match_cells_reference(const kernels::CellMatching& matching);

}  // namespace flies
