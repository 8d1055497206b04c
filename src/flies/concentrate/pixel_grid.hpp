#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/concentrate/concentrate_result.hpp"
#include "flies/concentrate/kernels/kernel_sums.hpp"

namespace flies {

/// Dropped flies sorted into the cells of an image grid, so that what looks for flies near a point visits those and
/// not all. Flies without fitness are left out. Keeps its memory when it is filled anew.
class PixelGrid {
 public:
  void reserve(std::size_t flies);

  /// @param reach_px of most searches to come: cells are a part of it
  void fill(std::span<const DroppedFly> flies, double reach_px);

  /// The number of flies in the grid, each at a place of its own.
  std::size_t size() const { return index_.size() - kernels::kPadding; }

  /// The fly at a place, as an index into those the grid was filled with.
  std::uint32_t index(std::size_t place) const { return index_[place]; }

  /// The flies within `reach_px` of `p`, and some farther ones.
  kernels::PointRuns near(const PixelPoint& p, double reach_px) const;

 private:
  static constexpr std::uint32_t kNoCell = UINT32_MAX;

  void lay_out(std::span<const DroppedFly> flies, double reach_px);
  std::size_t column(double u_px) const;
  std::size_t row(double v_px) const;

  double min_u_px_ = 0.0, min_v_px_ = 0.0;
  double columns_per_px_ = 0.0, rows_per_px_ = 0.0;
  std::size_t columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> starts_;  ///< the place of each cell's first fly, cells row by row
  std::vector<std::uint32_t> cell_of_fly_;
  std::vector<double> u_px_, v_px_, fitness_;  ///< in the order of the cells, padded
  std::vector<std::uint32_t> index_;
};

}  // namespace flies
