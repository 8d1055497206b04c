#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "flies/concentrate/concentrate.hpp"

namespace flies {

/// Dropped flies sorted into square image cells of one kernel reach, so that a kernel visits nine cells and not all
/// flies. Flies without fitness are left out.
class PixelGrid {
 public:
  PixelGrid(const std::vector<DroppedFly>& flies, double cell_px) : cell_px_(cell_px) {
    double max_u = std::numeric_limits<double>::lowest(), max_v = max_u;
    min_u_ = min_v_ = std::numeric_limits<double>::max();
    for (const auto& fly : flies) {
      if (!(fly.fitness > 0.0)) continue;
      min_u_ = std::min(min_u_, fly.pixel.u_px);
      min_v_ = std::min(min_v_, fly.pixel.v_px);
      max_u = std::max(max_u, fly.pixel.u_px);
      max_v = std::max(max_v, fly.pixel.v_px);
    }
    if (max_u < min_u_) return;
    columns_ = static_cast<int>((max_u - min_u_) / cell_px_) + 1;
    rows_ = static_cast<int>((max_v - min_v_) / cell_px_) + 1;
    // Counting sort: starts_[c] is where the flies of cell c begin.
    starts_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1);
    for (const auto& fly : flies)
      if (fly.fitness > 0.0) ++starts_[cell_index(fly.pixel) + 1];
    for (std::size_t c = 1; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    flies_.resize(starts_.back());
    auto next = starts_;
    for (const auto& fly : flies)
      if (fly.fitness > 0.0) flies_[next[cell_index(fly.pixel)]++] = fly;
  }

  /// Calls `use(fly)` for all flies within one cell edge of `p`, and some farther ones.
  template <class Use>
  void visit(const PixelPoint& p, const Use& use) const {
    if (flies_.empty()) return;
    const double column = std::floor((p.u_px - min_u_) / cell_px_), row = std::floor((p.v_px - min_v_) / cell_px_);
    if (!(column >= -1 && column <= columns_ && row >= -1 && row <= rows_)) return;
    const int c = static_cast<int>(column), r = static_cast<int>(row);
    const int first_column = std::max(c - 1, 0), last_column = std::min(c + 1, columns_ - 1);
    for (int y = std::max(r - 1, 0); y <= std::min(r + 1, rows_ - 1); ++y) {
      if (first_column > last_column) continue;
      // The cells of a row follow each other, and so do their flies.
      const auto begin = starts_[static_cast<std::size_t>(y * columns_ + first_column)];
      const auto end = starts_[static_cast<std::size_t>(y * columns_ + last_column + 1)];
      for (auto i = begin; i < end; ++i) use(flies_[i]);
    }
  }

 private:
  std::size_t cell_index(const PixelPoint& p) const {
    return static_cast<std::size_t>((p.v_px - min_v_) / cell_px_) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>((p.u_px - min_u_) / cell_px_);
  }

  double cell_px_;
  double min_u_ = 0.0, min_v_ = 0.0;
  int columns_ = 0, rows_ = 0;
  std::vector<std::size_t> starts_;
  std::vector<DroppedFly> flies_;
};

}  // namespace flies
