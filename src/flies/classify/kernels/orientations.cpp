// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation.
// No step depends on the length of vectors: pixels do not mix, and what is summed is summed in one order.
#include "flies/classify/kernels/orientations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/classify/kernels/orientations.cpp"
// Vectors without a compile-time size, which NEON serves as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kRowPadding>;
using D4 = hn::CappedTag<float, kBinsAside>;
constexpr std::size_t kLanes = hn::MaxLanes(D()), kLanes4 = hn::MaxLanes(D4());

HWY_ATTR void SquareRoots(float* values, std::size_t count) {
  const D d;
  for (std::size_t i = 0; i < count; i += kLanes) hn::StoreU(hn::Sqrt(hn::LoadU(d, values + i)), d, values + i);
}

/// Angle of (x, y) above the x axis over pi, where y is not negative: 0 to 1. Polynomial of OpenCV's fastAtan2, off by
/// less than 0.01 degrees.
template <class V>
HWY_INLINE V half_turns(V x, V y) {
  const D d;
  const auto over_pi = [](double value) { return static_cast<float>(value * std::numbers::inv_pi); };
  const auto ax = hn::Abs(x);
  const auto ratio = hn::Div(hn::Min(ax, y), hn::Add(hn::Max(ax, y), hn::Set(d, 1e-20F)));
  const auto square = hn::Mul(ratio, ratio);
  auto turn = hn::Set(d, over_pi(-0.04432655554792128));
  for (const float next : {over_pi(0.1555786518463281), over_pi(-0.3258083974640975), over_pi(0.9997878412794807)})
    turn = hn::Add(hn::Mul(turn, square), hn::Set(d, next));
  turn = hn::Mul(turn, ratio);
  const auto acute = hn::IfThenElse(hn::Gt(y, ax), hn::Sub(hn::Set(d, 0.5F), turn), turn);
  return hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(hn::Set(d, 1.0F), acute), acute);
}

/// Of one row of pixels: which orientation each gradient is at or above, and what it gives to that and to the next.
template <class V>
HWY_INLINE void vote(const float* above, const float* here, const float* below, float bins, V& bin, V& to_bin,
                     V& to_next) {
  const D d;
  const auto one = hn::Set(d, 1.0F), zero = hn::Zero(d);
  const auto du = hn::Sub(hn::LoadU(d, here + 1), hn::LoadU(d, here - 1));
  const auto dv = hn::Sub(hn::LoadU(d, below), hn::LoadU(d, above));
  const auto magnitude = hn::Sqrt(hn::Add(hn::Mul(du, du), hn::Mul(dv, dv)));
  // Opposite gradients count as one: a light coat before a dark wall is a dark coat before a light wall.
  const auto x = hn::IfThenElse(hn::Lt(dv, zero), hn::Neg(du), du);
  // In bins, from the centre of the first, on a ring of `bins`: -0.5 to `bins` - 0.5.
  const auto place = hn::Sub(hn::Mul(half_turns(x, hn::Abs(dv)), hn::Set(d, bins)), hn::Set(d, 0.5F));
  const auto lower = hn::Floor(place);
  // The last bin is the neighbour of the first.
  bin = hn::IfThenElse(hn::Lt(lower, zero), hn::Set(d, bins - 1.0F), lower);
  to_bin = hn::Mul(magnitude, hn::Sub(one, hn::Sub(place, lower)));
  to_next = hn::Mul(magnitude, hn::Add(one, hn::Sub(place, hn::Add(lower, one))));
}

template <std::size_t kSums>
HWY_ATTR void add_votes(const float* const* rows, std::size_t width, int bins, std::size_t plane_size,
                        const CellRow* cells) {
  const D d;
  const auto last = static_cast<float>(bins - 1);
  for (std::size_t u = 0; u < width; u += kLanes) {
    hn::Vec<D> bins_of[kRowsAtOnce], to_bin[kRowsAtOnce], to_next[kRowsAtOnce];
    hn::Mask<D> is_before[kRowsAtOnce];  // in the bin before the one at hand; before the first comes the last
    for (std::size_t r = 0; r < kRowsAtOnce; ++r) {
      vote(rows[r] + u, rows[r + 1] + u, rows[r + 2] + u, last + 1.0F, bins_of[r], to_bin[r], to_next[r]);
      is_before[r] = hn::Eq(bins_of[r], hn::Set(d, last));
    }
    std::size_t i = u;
    for (float bin = 0.0F; bin <= last; bin += 1.0F, i += plane_size) {
      hn::Vec<D> shares[kRowsAtOnce];
      for (std::size_t r = 0; r < kRowsAtOnce; ++r) {
        const auto is_here = hn::Eq(bins_of[r], hn::Set(d, bin));
        shares[r] = hn::IfThenElse(is_before[r], to_next[r], hn::IfThenElseZero(is_here, to_bin[r]));
        is_before[r] = is_here;
      }
      for (std::size_t k = 0; k < kSums; ++k) {
        auto sum = hn::LoadU(d, cells[k].sums + i);
        for (std::size_t r = 0; r < kRowsAtOnce; ++r)
          sum = hn::Add(sum, hn::Mul(shares[r], hn::Set(d, cells[k].weights[r])));
        hn::StoreU(sum, d, cells[k].sums + i);
      }
    }
  }
}

HWY_ATTR void AddVotes(const float* const* rows, std::size_t width, int bins, std::size_t plane_size,
                       const CellRow* cells, std::size_t count) {
  constexpr std::size_t kAtOnce = 3;  // as many as a row of pixels feeds with the default geometry
  for (; count >= kAtOnce; count -= kAtOnce, cells += kAtOnce) add_votes<kAtOnce>(rows, width, bins, plane_size, cells);
  if (count == 2) add_votes<2>(rows, width, bins, plane_size, cells);
  if (count == 1) add_votes<1>(rows, width, bins, plane_size, cells);
}

HWY_ATTR void Interleave(const float* planes, std::size_t plane_size, float* out) {
  const D d;
  for (std::size_t i = 0; i < plane_size; i += kLanes) {
    const auto plane = [&](std::size_t k) HWY_ATTR { return hn::LoadU(d, planes + k * plane_size + i); };
    hn::StoreInterleaved4(plane(0), plane(1), plane(2), plane(3), d, out + kBinsAside * i);
  }
}

HWY_ATTR void AddColumns(const float* columns, const float* weights, std::size_t count, std::size_t stride,
                         std::size_t cells, std::size_t bins, std::size_t out_stride, float* out) {
  const D d;
  const D4 d4;
  for (std::size_t c = 0; c < cells; ++c, columns += kBinsAside * stride, out += out_stride) {
    // Every fourth column to one sum of four bins, so that all vectors add in one order.
    alignas(64) float sums[kRowPadding];
    for (std::size_t k = 0; k < kRowPadding; k += kLanes) {
      auto total = hn::Zero(d);
      for (std::size_t i = k; i < kBinsAside * count; i += kRowPadding)
        total = hn::Add(total, hn::Mul(hn::LoadU(d, columns + i), hn::LoadU(d, weights + i)));
      hn::StoreU(total, d, sums + k);
    }
    alignas(64) float totals[kBinsAside];
    for (std::size_t k = 0; k < kBinsAside; k += kLanes4) {
      const auto sum = [&](std::size_t i) HWY_ATTR { return hn::LoadU(d4, sums + kBinsAside * i + k); };
      hn::StoreU(hn::Add(hn::Add(sum(0), sum(2)), hn::Add(sum(1), sum(3))), d4, totals + k);
    }
    // Not a loop up to `bins`: the compiler calls a function for that.
    out[0] = totals[0];
    if (bins > 1) out[1] = totals[1];
    if (bins > 2) out[2] = totals[2];
    if (bins > 3) out[3] = totals[3];
  }
}

/// In four sums, so that all vectors add in one order; what is left over goes to the first.
HWY_ATTR float sum_of_squares(const float* values, std::size_t size) {
  const D4 d;
  const std::size_t whole = size / kBinsAside * kBinsAside;
  float sums[kBinsAside];
  for (std::size_t k = 0; k < kBinsAside; k += kLanes4) {
    auto total = hn::Zero(d);
    for (std::size_t i = k; i < whole; i += kBinsAside) {
      const auto value = hn::LoadU(d, values + i);
      total = hn::Add(total, hn::Mul(value, value));
    }
    hn::StoreU(total, d, sums + k);
  }
  for (std::size_t i = whole; i < size; ++i) sums[0] += values[i] * values[i];
  return (sums[0] + sums[2]) + (sums[1] + sums[3]);
}

HWY_ATTR void NormaliseBlock(float* block, std::size_t size) {
  constexpr float kClip = 0.2F;
  const D4 d;
  const std::size_t whole = size / kLanes4 * kLanes4;
  const float first = 1.0F / (std::sqrt(sum_of_squares(block, size)) + 0.1F * static_cast<float>(size));
  for (std::size_t i = 0; i < whole; i += kLanes4)
    hn::StoreU(hn::Min(hn::Mul(hn::LoadU(d, block + i), hn::Set(d, first)), hn::Set(d, kClip)), d, block + i);
  for (std::size_t i = whole; i < size; ++i) block[i] = std::min(block[i] * first, kClip);
  const float second = 1.0F / (std::sqrt(sum_of_squares(block, size)) + 1e-3F);
  for (std::size_t i = 0; i < whole; i += kLanes4)
    hn::StoreU(hn::Mul(hn::LoadU(d, block + i), hn::Set(d, second)), d, block + i);
  for (std::size_t i = whole; i < size; ++i) block[i] *= second;
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(SquareRoots);
HWY_EXPORT(AddVotes);
HWY_EXPORT(Interleave);
HWY_EXPORT(AddColumns);
HWY_EXPORT(NormaliseBlock);

void square_roots(float* values, std::size_t count) { HWY_DYNAMIC_DISPATCH(SquareRoots)(values, count); }

void add_votes(const std::array<const float*, kRowsAtOnce + 2>& rows, std::size_t width, int bins,
               std::size_t plane_size, std::span<const CellRow> cells) {
  HWY_DYNAMIC_DISPATCH(AddVotes)(rows.data(), width, bins, plane_size, cells.data(), cells.size());
}

void interleave(const float* planes, std::size_t plane_size, float* out) {
  HWY_DYNAMIC_DISPATCH(Interleave)(planes, plane_size, out);
}

void add_columns(const float* columns, const float* weights, std::size_t count, std::size_t stride, std::size_t cells,
                 std::size_t bins, std::size_t out_stride, float* out) {
  HWY_DYNAMIC_DISPATCH(AddColumns)(columns, weights, count, stride, cells, bins, out_stride, out);
}

void normalise_block(float* block, std::size_t size) { HWY_DYNAMIC_DISPATCH(NormaliseBlock)(block, size); }

}  // namespace flies::kernels
#endif
