#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/core/gray_view.hpp"

namespace flies::kernels {

/// Size of a cell in the image: eight columns, and four rows that may be some rows apart.
constexpr int kCellColumns = 8, kCellRows = 4;

/// Vectors may work on so many disparities at a time; rows of disparities are padded to a multiple of it.
constexpr int kDisparityLanes = 64;

/// Weights of the matching, in the unit of cell costs: half a grey level of gradient, summed over a cell. Each is at
/// most 63 but `max_cost`, which is at most 190, so that all sums fit a byte.
struct CellWeights {
  int max_gradient = 7;  ///< gradients are clipped to this, 1..7
  int max_cost = 150;    ///< of a cell; what differs more differs by chance
  int slant_across = 1;  ///< a step of one disparity between neighbouring columns
  int slant_upward = 4;  ///< a step of one disparity between neighbouring bands
  int jump = 48;         ///< any larger step
};

/// The cells of a pair and the disparities that each may have. Disparities are numbered from the nearest one down:
/// disparity k is `nearest_px` - k.
struct CellMatching {
  RectifiedPair pair;
  int columns = 0;              ///< of cells; the first covers the columns 0 to 7 of the left image
  int bands = 0;                ///< rows of cells, from the bottom up
  int bottom_row = 0;           ///< of the lowest band, at most `height_px` - 2
  int row_step = 2;             ///< from a row of a cell to the next one above it; all rows stay in 1..height_px - 2
  int nearest_px = 0;           ///< highest disparity
  int disparities = 0;          ///< how many, at least 1
  std::span<const int> reach;   ///< of each band: how many of them, from the nearest, may lie on the road or above it
  std::span<const int> recede;  ///< of each band but the last: disparities that the road loses up to the next one, >= 0
  CellWeights weights;

  std::size_t cells() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(bands); }
  int stride() const { return (disparities + kDisparityLanes - 1) / kDisparityLanes * kDisparityLanes; }
};

/// The disparity of a cell.
struct CellMatch {
  std::uint16_t disparity = 0;                   ///< its number
  std::uint8_t before = 0, cost = 0, after = 0;  ///< smoothed costs at the number before, there, and at the one after
  std::uint8_t second = 0;                       ///< least smoothed cost more than two numbers away
};

/// Memory of `match_cells`.
struct CellMemory {
  std::vector<std::uint8_t> left, right;  ///< clipped gradients of the rows of all cells
  std::vector<std::uint8_t> cost;         ///< cell by cell, disparity by disparity
  std::vector<std::uint8_t> detour;       ///< the same: what the paths that lead to it add
  std::vector<std::uint8_t> path;         ///< cheapest paths so far
};

/// Matches all cells: the sum of absolute differences of horizontal gradients, smoothed semi-globally (Hirschmüller
/// 2008) along four paths: from both sides, and from above and below, where a path may follow an upright surface (same
/// disparity) or the road (`recede`). The same numbers on every CPU.
/// @param matches band by band, column by column
void match_cells(const CellMatching& matching, CellMemory& memory, std::vector<CellMatch>& matches);

}  // namespace flies::kernels
