// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation.
#include "flies/scan/kernels/match_cells.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/scan/kernels/match_cells.cpp"
// Vectors without a compile-time size: rows of disparities are padded to 64.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D8 = hn::CappedTag<std::uint8_t, kDisparityLanes>;
using D16 = hn::CappedTag<std::int16_t, kDisparityLanes / 2>;
using DHalf = hn::Rebind<std::uint8_t, D16>;
constexpr std::size_t kLanes = hn::MaxLanes(D8());
static_assert(kDisparityLanes % kLanes == 0);

/// More than any cost or path.
constexpr std::uint8_t kNever = 255;

/// Disparities beyond the ends of a path's row that may be asked for: of the road, which recedes.
constexpr std::size_t kMargin = 64;

/// Clipped horizontal gradients (Sobel, halved) of one row, 0..2 max; the first and the last column are flat.
HWY_ATTR void read_gradients(const GrayView& image, int v, int max, std::uint8_t* gradient) {
  const std::uint8_t *above = image.row(v - 1), *row = image.row(v), *below = image.row(v + 1);
  const int last = image.width_px - 1;
  gradient[0] = gradient[last] = static_cast<std::uint8_t>(max);
  int u = 1;
#if HWY_TARGET != HWY_SCALAR
  const D16 d;
  const DHalf d_half;
  const auto low = hn::Set(d, static_cast<std::int16_t>(-2 * max)),
             high = hn::Set(d, static_cast<std::int16_t>(2 * max));
  for (; u + static_cast<int>(hn::MaxLanes(d)) <= last; u += static_cast<int>(hn::MaxLanes(d))) {
    const auto difference = [&](const std::uint8_t* line) HWY_ATTR {
      return hn::Sub(hn::PromoteTo(d, hn::LoadU(d_half, line + u + 1)),
                     hn::PromoteTo(d, hn::LoadU(d_half, line + u - 1)));
    };
    const auto middle = difference(row);
    const auto sum = hn::Add(hn::Add(difference(above), difference(below)), hn::Add(middle, middle));
    const auto clipped = hn::ShiftRight<1>(hn::Add(hn::Min(hn::Max(sum, low), high), high));
    hn::StoreU(hn::DemoteTo(d_half, clipped), d_half, gradient + u);
  }
#endif
  for (; u < last; ++u) {
    const auto difference = [&](const std::uint8_t* line) { return line[u + 1] - line[u - 1]; };
    const int sum = difference(above) + 2 * difference(row) + difference(below);
    gradient[u] = static_cast<std::uint8_t>((std::clamp(sum, -2 * max, 2 * max) + 2 * max) >> 1);
  }
}

/// The gradients of all rows of all cells, the right ones with room for every disparity on both sides.
struct Gradients {
  const std::uint8_t* left = nullptr;
  const std::uint8_t* right = nullptr;
  std::size_t left_stride = 0, right_stride = 0;
};

HWY_ATTR Gradients read_all_gradients(const CellMatching& m, CellMemory& memory) {
  const int max = m.weights.max_gradient, width = m.pair.left.width_px;
  const auto rows = static_cast<std::size_t>(m.bands) * kCellRows;
  const auto ahead = static_cast<std::size_t>(std::max(0, m.nearest_px));
  const auto beyond = static_cast<std::size_t>(std::max(0, m.stride() - m.nearest_px));
  Gradients g;
  g.left_stride = static_cast<std::size_t>(width);
  g.right_stride = ahead + static_cast<std::size_t>(width) + beyond;
  memory.left.resize(rows * g.left_stride);
  memory.right.resize(rows * g.right_stride + kDisparityLanes);
  for (std::size_t row = 0; row < rows; ++row) {
    const int v = m.bottom_row - static_cast<int>(row) * m.row_step;
    read_gradients(m.pair.left, v, max, memory.left.data() + row * g.left_stride);
    std::uint8_t* right = memory.right.data() + row * g.right_stride;
    std::fill_n(right, ahead, static_cast<std::uint8_t>(max));
    read_gradients(m.pair.right, v, max, right + ahead);
    std::fill_n(right + ahead + width, beyond, static_cast<std::uint8_t>(max));
  }
  g.left = memory.left.data();
  g.right = memory.right.data() + ahead;
  return g;
}

/// Costs of one cell at the disparities of a vector from number `first` on.
HWY_INLINE hn::Vec<D8> cell_costs(const CellMatching& m, const Gradients& g, std::size_t band, int column, int first) {
  const D8 d;
  const hn::RebindToSigned<D8> d_signed;
  const auto row_sum = [&](std::size_t row) HWY_ATTR {
    const std::uint8_t* left = g.left + row * g.left_stride + column * kCellColumns;
    const std::uint8_t* right = g.right + row * g.right_stride + column * kCellColumns - m.nearest_px + first;
    auto sum = hn::Zero(d);
    for (int i = 0; i < kCellColumns; ++i) {
      const auto l = hn::Set(d_signed, static_cast<std::int8_t>(left[i]));
      const auto r = hn::BitCast(d_signed, hn::LoadU(d, right + i));
      sum = hn::Add(sum, hn::BitCast(d, hn::Abs(hn::Sub(l, r))));
    }
    return sum;
  };
  static_assert(kCellRows == 4);
  const std::size_t row = band * kCellRows;
  const auto lower = hn::Add(row_sum(row), row_sum(row + 1)), upper = hn::Add(row_sum(row + 2), row_sum(row + 3));
  return hn::Min(hn::AverageRound(lower, upper), hn::Set(d, static_cast<std::uint8_t>(m.weights.max_cost)));
}

HWY_ATTR void find_costs(const CellMatching& m, const Gradients& g, std::size_t band, std::uint8_t* cost) {
  const D8 d;
  const int stride = m.stride(), width = m.pair.left.width_px, reach = m.reach[band];
  for (int column = 0; column < m.columns; ++column, cost += stride) {
    for (int k = 0; k < reach; k += static_cast<int>(kLanes))
      hn::StoreU(cell_costs(m, g, band, column, k), d, cost + k);
    // Partners outside of the right image are as good as none.
    const int u = column * kCellColumns;
    const int inside_from = std::clamp(m.nearest_px - u, 0, reach);
    const int inside_to = std::clamp(width - kCellColumns - u + m.nearest_px + 1, inside_from, reach);
    const auto none = static_cast<std::uint8_t>(m.weights.max_cost);
    std::fill(cost, cost + inside_from, none);
    std::fill(cost + inside_to, cost + reach, none);
    std::fill(cost + reach, cost + stride, kNever);
  }
}

/// The least of all lanes.
HWY_INLINE std::uint8_t least(hn::Vec<D8> v) {
  HWY_ALIGN std::uint8_t lanes[kLanes];
#if HWY_TARGET == HWY_SCALAR
  hn::Store(v, D8(), lanes);
  return lanes[0];
#else
  if constexpr (kLanes > 16) {
    const hn::Half<D8> half;
    const auto folded = hn::Min(hn::LowerHalf(half, v), hn::UpperHalf(half, v));
    if constexpr (kLanes > 32) {
      const hn::Half<hn::Half<D8> > quarter;
      hn::Store(hn::Min(hn::LowerHalf(quarter, folded), hn::UpperHalf(quarter, folded)), quarter, lanes);
    } else {
      hn::Store(folded, half, lanes);
    }
  } else {
    hn::Store(v, D8(), lanes);
  }
  const hn::FixedTag<std::uint8_t, 16> d;
  auto x = hn::Load(d, lanes);
  x = hn::Min(x, hn::ShiftRightBytes<8>(d, x));
  x = hn::Min(x, hn::BitCast(d, hn::ShiftRight<32>(hn::BitCast(hn::FixedTag<std::uint64_t, 2>(), x))));
  x = hn::Min(x, hn::BitCast(d, hn::ShiftRight<16>(hn::BitCast(hn::FixedTag<std::uint64_t, 2>(), x))));
  x = hn::Min(x, hn::BitCast(d, hn::ShiftRight<8>(hn::BitCast(hn::FixedTag<std::uint64_t, 2>(), x))));
  return hn::GetLane(x);
#endif
}

struct PathWeights {
  std::uint8_t slant = 0, jump = 0;
};

/// Leads a path on to the next cell: each disparity from the same one, from its neighbours, from the one that follows
/// the road, or from any by a jump.
/// @param path    costs of the cheapest paths to the cell before, less the least of them; overwritten. With a margin of
///                `kNever` on both sides
/// @param road    added to a number to find the one that the road comes from
/// @param scratch as long as `path`
HWY_INLINE void step_path(std::uint8_t* path, std::uint8_t* scratch, const std::uint8_t* cost, std::uint8_t* detour,
                          int reach, int road, PathWeights weights) {
  const D8 d;
  constexpr int kStep = static_cast<int>(kLanes);
  const auto slant = hn::Set(d, weights.slant), jump = hn::Set(d, weights.jump);
  auto lowest = hn::Set(d, kNever);
  for (int k = 0; k < reach; k += kStep) {
    const auto same = hn::Min(hn::LoadU(d, path + k), hn::LoadU(d, path + k + road));
    const auto beside = hn::Min(hn::LoadU(d, path + k - 1), hn::LoadU(d, path + k + 1));
    const auto added = hn::Min(hn::Min(same, hn::SaturatedAdd(beside, slant)), jump);
    hn::StoreU(hn::SaturatedAdd(hn::LoadU(d, detour + k), added), d, detour + k);
    const auto total = hn::SaturatedAdd(hn::LoadU(d, cost + k), added);
    hn::StoreU(total, d, scratch + k);
    lowest = hn::Min(lowest, total);
  }
  const auto least_lanes = hn::Set(d, least(lowest));
  int k = 0;
  for (; k < reach; k += kStep) hn::StoreU(hn::SaturatedSub(hn::LoadU(d, scratch + k), least_lanes), d, path + k);
  // What the last vector has in excess leads nowhere.
  std::fill(path + reach, path + k, kNever);
}

/// The paths to a row or a column of cells: of each the costs of its disparities, with a margin of `kNever` around.
class Paths {
 public:
  Paths(std::uint8_t* memory, std::size_t stride) : memory_(memory), stride_(stride + 2 * kMargin) {}
  static std::size_t size(std::size_t paths, std::size_t stride) { return paths * (stride + 2 * kMargin); }

  std::uint8_t* of(std::size_t path) const { return memory_ + path * stride_ + kMargin; }
  /// Paths that come from nowhere.
  void start(std::size_t paths, int reach) const {
    std::fill_n(memory_, paths * stride_, kNever);
    for (std::size_t i = 0; i < paths; ++i) std::fill_n(of(i), reach, std::uint8_t{0});
  }
  /// From here on the disparities beyond lead no farther.
  void cut(std::size_t path, int reach) const { std::fill(of(path) + reach, of(path) + stride_ - 2 * kMargin, kNever); }

 private:
  std::uint8_t* memory_;
  std::size_t stride_;
};

/// Finds the disparity of a cell, and what else it could be.
/// @param sum memory with a margin of `kNever`
HWY_INLINE CellMatch choose(const std::uint8_t* cost, const std::uint8_t* detour, int reach, int stride,
                            std::uint8_t* sum) {
  const D8 d;
  auto lowest = hn::Set(d, kNever);
  for (int k = 0; k < reach; k += static_cast<int>(kLanes)) {
    const auto smoothed = hn::SaturatedAdd(hn::LoadU(d, cost + k), hn::LoadU(d, detour + k));
    hn::StoreU(smoothed, d, sum + k);
    lowest = hn::Min(lowest, smoothed);
  }
  std::fill(sum + reach, sum + stride, kNever);
  CellMatch match;
  match.cost = least(lowest);
  const auto best =
      static_cast<const std::uint8_t*>(std::memchr(sum, match.cost, static_cast<std::size_t>(reach))) - sum;
  match.disparity = static_cast<std::uint16_t>(best);
  match.before = sum[best - 1];
  match.after = sum[best + 1];
  constexpr int kAside = 2;
  std::fill(sum + best - kAside, sum + best + kAside + 1, kNever);
  lowest = hn::Set(d, kNever);
  for (int k = 0; k < reach; k += static_cast<int>(kLanes)) lowest = hn::Min(lowest, hn::LoadU(d, sum + k));
  match.second = least(lowest);
  return match;
}

HWY_ATTR void MatchCells(const CellMatching& m, CellMemory& memory, std::vector<CellMatch>& matches) {
  const auto stride = static_cast<std::size_t>(m.stride());
  const auto columns = static_cast<std::size_t>(m.columns), bands = static_cast<std::size_t>(m.bands);
  const auto& weights = m.weights;
  const PathWeights across{static_cast<std::uint8_t>(weights.slant_across), static_cast<std::uint8_t>(weights.jump)};
  const PathWeights upward{static_cast<std::uint8_t>(weights.slant_upward), static_cast<std::uint8_t>(weights.jump)};
  const auto recede = [&](std::size_t band) { return std::clamp(m.recede[band], 0, static_cast<int>(kMargin) - 1); };
  memory.cost.resize(m.cells() * stride);
  memory.detour.resize(m.cells() * stride);
  memory.path.resize(Paths::size(columns + 3, stride));
  matches.resize(m.cells());
  const Paths upright(memory.path.data(), stride);
  const Paths level(memory.path.data() + Paths::size(columns, stride), stride);
  std::uint8_t* scratch = level.of(2);
  const auto cost = [&](std::size_t band, std::size_t column) {
    return memory.cost.data() + (band * columns + column) * stride;
  };
  const auto detour = [&](std::size_t band, std::size_t column) {
    return memory.detour.data() + (band * columns + column) * stride;
  };

  // Band by band, while it is in the cache: its costs, the paths across it, those from below.
  const Gradients gradients = read_all_gradients(m, memory);
  upright.start(columns, m.reach[0]);
  for (std::size_t band = 0; band < bands; ++band) {
    const int reach = m.reach[band];
    find_costs(m, gradients, band, cost(band, 0));
    std::fill(detour(band, 0), detour(band, columns), std::uint8_t{0});
    level.start(2, reach);
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t back = columns - 1 - column;
      step_path(level.of(0), scratch, cost(band, column), detour(band, column), reach, 0, across);
      step_path(level.of(1), scratch, cost(band, back), detour(band, back), reach, 0, across);
    }
    const int from = band > 0 ? -recede(band - 1) : 0;
    for (std::size_t column = 0; column < columns; ++column)
      step_path(upright.of(column), scratch, cost(band, column), detour(band, column), reach, from, upward);
  }
  // Back down: the paths from above, which are the last.
  upright.start(columns, m.reach[bands - 1]);
  level.start(3, 0);
  for (std::size_t band = bands; band-- > 0;) {
    const int reach = m.reach[band], from = band + 1 < bands ? recede(band) : 0;
    for (std::size_t column = 0; column < columns; ++column) {
      step_path(upright.of(column), scratch, cost(band, column), detour(band, column), reach, from, upward);
      upright.cut(column, reach);
      matches[band * columns + column] =
          choose(cost(band, column), detour(band, column), reach, m.stride(), level.of(0));
    }
  }
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(MatchCells);

void match_cells(const CellMatching& matching, CellMemory& memory, std::vector<CellMatch>& matches) {
  assert(matching.reach.size() == static_cast<std::size_t>(matching.bands));
  HWY_DYNAMIC_DISPATCH(MatchCells)(matching, memory, matches);
}

}  // namespace flies::kernels
#endif
