// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation.
#include "flies/evolve/kernels/row_sums.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/evolve/kernels/row_sums.cpp"
// Vectors without a compile-time size: a row is too narrow to gain from them, NEON serves it as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR

void SumRows(const std::uint8_t* left, std::span<const std::uint8_t* const> right, RowSums* sums) {
  sum_rows_scalar(left, right, sums);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

using D16 = hn::FixedTag<std::int16_t, 8>;
using D32 = hn::FixedTag<std::int32_t, 4>;
using D8 = hn::FixedTag<std::uint8_t, 16>;

/// The two halves of a row of 16 columns.
struct Row {
  hn::Vec<D16> first, last;
};

HWY_INLINE Row load(const std::uint8_t* row, hn::Vec<D8> inside) {
  const auto pixels = hn::And(hn::LoadU(D8(), row), inside);
  const hn::Half<D8> half;
  return {hn::PromoteTo(D16(), hn::LowerHalf(half, pixels)), hn::PromoteTo(D16(), hn::UpperHalf(half, pixels))};
}

HWY_INLINE hn::Vec<D32> sum_of_products(const Row& a, const Row& b) {
  const D32 d;
  auto low = hn::Zero(d), high = hn::Zero(d);
  low = hn::ReorderWidenMulAccumulate(d, a.first, b.first, low, high);
  low = hn::ReorderWidenMulAccumulate(d, a.last, b.last, low, high);
  return hn::Add(low, high);
}

HWY_ATTR void SumRows(const std::uint8_t* left, std::span<const std::uint8_t* const> right, RowSums* sums) {
  const D32 d;
  const auto inside = hn::VecFromMask(D8(), hn::FirstN(D8(), kRowColumns));
  const Row l = load(left, inside);
  const auto one = hn::Set(D16(), 1);
  for (std::size_t i = 0; i < right.size(); ++i) {
    const Row r = load(right[i], inside);
    // Three sums over four lanes each, and one that is not needed.
    const auto levels = sum_of_products({hn::Add(r.first, r.last), hn::Zero(D16())}, {one, one});
    const auto squares = sum_of_products(r, r), products = sum_of_products(l, r);
    const auto pairs = hn::Add(hn::InterleaveLower(d, levels, products), hn::InterleaveUpper(d, levels, products));
    const auto others = hn::Add(hn::InterleaveLower(d, squares, squares), hn::InterleaveUpper(d, squares, squares));
    alignas(16) std::int32_t total[4];
    hn::Store(hn::Add(hn::ConcatLowerLower(d, others, pairs), hn::ConcatUpperUpper(d, others, pairs)), d, total);
    sums[i] = {total[0], total[2], total[1]};
  }
}

#endif
}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(SumRows);

void sum_rows(const std::uint8_t* left, std::span<const std::uint8_t* const> right, RowSums* sums) {
  HWY_DYNAMIC_DISPATCH(SumRows)(left, right, sums);
}

void sum_rows_scalar(const std::uint8_t* left, std::span<const std::uint8_t* const> right, RowSums* sums) {
  for (std::size_t i = 0; i < right.size(); ++i) {
    RowSums sum;
    for (int column = 0; column < kRowColumns; ++column) {
      const int l = left[column], r = right[i][column];
      sum.right += r;
      sum.squares += r * r;
      sum.products += l * r;
    }
    sums[i] = sum;
  }
}

}  // namespace flies::kernels
#endif
