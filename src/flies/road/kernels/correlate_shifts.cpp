// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation. It is
// compiled without contraction of products and sums, which would round differently where the CPU can fuse them.
#include "flies/road/kernels/correlate_shifts.hpp"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/road/kernels/correlate_shifts.cpp"
// Vectors without a compile-time size: the last ones could reach beyond the strips.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D64 = hn::CappedTag<double, 8>;

/// Grey levels of the right image are multiplied by this, which makes them integers.
constexpr int kScale = kShiftSteps;

constexpr std::size_t kColumns = kShiftColumns, kRows = kShiftRows;

/// Columns are multiplied two at a time; the last one has a column of zeros beside it.
constexpr std::size_t kPairs = (kColumns + 1) / 2;

constexpr std::size_t kPaddedShifts = kMaxShifts + 16;
constexpr std::size_t kStrip = kPaddedShifts + 2 * kPairs;

/// Two neighbouring columns in one lane of 32 bits.
struct ColumnPair {
  std::int16_t column, next;
};

/// The neighbourhood of the left image. Of each row n l - (sum l), which centres the row that it is multiplied with,
/// too.
struct LeftRows {
  ColumnPair centred[kRows][kPairs];
  double variance = 0.0;
};

/// The rows of the right image that all its neighbourhoods lie in, every column beside the next one.
struct RightRows {
  HWY_ALIGN ColumnPair columns[kRows][kStrip];
};

HWY_INLINE void read_left(const ShiftedPatches& patches, LeftRows& left) {
  for (std::size_t row = 0; row < kRows; ++row) {
    const std::uint8_t* l = patches.left + static_cast<std::ptrdiff_t>(row) * patches.left_stride;
    std::int32_t sum = 0, squares = 0;
    for (std::size_t i = 0; i < kColumns; ++i) {
      sum += l[i];
      squares += l[i] * l[i];
    }
    const auto centred = [&](std::size_t i) { return static_cast<std::int16_t>(kShiftColumns * l[i] - sum); };
    for (std::size_t k = 0; k < kPairs; ++k)
      left.centred[row][k] = {centred(2 * k), 2 * k + 1 < kColumns ? centred(2 * k + 1) : std::int16_t{0}};
    left.variance += kShiftColumns * squares - sum * sum;
  }
}

HWY_INLINE void read_right(const ShiftedPatches& patches, RightRows& right) {
  const std::size_t columns = static_cast<std::size_t>(patches.shifts) + kColumns - 1;
  for (std::size_t row = 0; row < kRows; ++row) {
    const std::uint8_t* pixel = patches.right + static_cast<std::ptrdiff_t>(row) * patches.right_stride;
    std::int16_t r[kStrip + 1] = {};
    for (std::size_t i = 0; i < columns; ++i)
      r[i] = static_cast<std::int16_t>(kScale * pixel[i] + patches.fraction16 * (pixel[i + 1] - pixel[i]));
    for (std::size_t i = 0; i < kStrip; ++i) right.columns[row][i] = {r[i], r[i + 1]};
  }
}

#if HWY_TARGET == HWY_SCALAR

using D32 = hn::CappedTag<std::int32_t, 1>;
using Pairs = ColumnPair;

HWY_INLINE Pairs repeat(ColumnPair pair) { return pair; }
HWY_INLINE Pairs load(const ColumnPair* pairs) { return *pairs; }
HWY_INLINE Pairs without_next(Pairs pairs) { return {pairs.column, 0}; }

/// Sums of products, one for each lane of a vector of pairs.
class ProductSums {
 public:
  HWY_INLINE void add(Pairs a, Pairs b) { sum_ += a.column * b.column + a.next * b.next; }
  HWY_INLINE void store(std::int32_t* to) const { *to = sum_; }

 private:
  std::int32_t sum_ = 0;
};

#else

using D16 = hn::CappedTag<std::int16_t, 32>;
using D32 = hn::RepartitionToWide<D16>;
using Pairs = hn::Vec<D16>;

HWY_INLINE Pairs repeat(ColumnPair pair) {
  std::int32_t lane = 0;
  std::memcpy(&lane, &pair, sizeof lane);
  return hn::BitCast(D16(), hn::Set(D32(), lane));
}
HWY_INLINE Pairs load(const ColumnPair* pairs) { return hn::LoadU(D16(), &pairs->column); }
HWY_INLINE Pairs without_next(Pairs pairs) {
  return hn::BitCast(D16(), hn::And(hn::BitCast(D32(), pairs), hn::Set(D32(), 0xffff)));
}

/// Sums of products, one for each lane of a vector of pairs.
class ProductSums {
 public:
  HWY_INLINE ProductSums() : some_(hn::Zero(D32())), others_(hn::Zero(D32())) {}
  HWY_INLINE void add(Pairs a, Pairs b) { some_ = hn::ReorderWidenMulAccumulate(D32(), a, b, some_, others_); }
  HWY_INLINE void store(std::int32_t* to) const { hn::Store(hn::RearrangeToOddPlusEven(some_, others_), D32(), to); }

 private:
  hn::Vec<D32> some_, others_;
};

#endif

/// What the coefficients are made of, for each place. All sums are exact integers: a covariance times the square of the
/// columns stays below 25^2 / 4 * 255 * (16 * 255) in each row, which five rows make 8e8, whatever wraps around on the
/// way; a sum of squares below 5 * 25 * (16 * 255)^2 = 2.08e9.
struct Sums {
  HWY_ALIGN std::int32_t covariance[kPaddedShifts];
  HWY_ALIGN std::int32_t squares[kPaddedShifts];
  HWY_ALIGN std::int32_t of_row[kRows][kPaddedShifts];
};

/// Those of as many places as a vector has lanes.
HWY_INLINE void add_up(const LeftRows& left, const RightRows& right, std::size_t first, Sums& sums) {
  const auto ones = repeat({1, 1});
  ProductSums covariance, squares;
  for (std::size_t row = 0; row < kRows; ++row) {
    ProductSums sum;
    for (std::size_t k = 0; k < kPairs; ++k) {
      auto r = load(&right.columns[row][first + 2 * k]);
      if (2 * k + 1 == kColumns) r = without_next(r);
      covariance.add(repeat(left.centred[row][k]), r);
      squares.add(r, r);
      sum.add(r, ones);
    }
    sum.store(sums.of_row[row] + first);
  }
  covariance.store(sums.covariance + first);
  squares.store(sums.squares + first);
}

HWY_ATTR void CorrelateShifts(const ShiftedPatches& patches, float* coefficient) {
  const D64 d;
  const hn::Rebind<std::int32_t, D64> d_int;
  const hn::Rebind<float, D64> d_float;
  LeftRows left;
  RightRows right;
  Sums sums;
  HWY_ALIGN float result[kPaddedShifts];
  const auto shifts = static_cast<std::size_t>(patches.shifts);
  read_left(patches, left);
  read_right(patches, right);
  for (std::size_t s = 0; s < shifts; s += hn::MaxLanes(D32())) add_up(left, right, s, sums);

  const double noise = kShiftRows * kShiftColumns * kShiftColumns * patches.noise_gray2;
  const auto left_variance = hn::Set(d, left.variance + noise);
  for (std::size_t s = 0; s < shifts; s += hn::MaxLanes(d)) {
    const auto as_double = [&](const std::int32_t* sum) HWY_ATTR { return hn::PromoteTo(d, hn::Load(d_int, sum + s)); };
    auto variance = hn::Mul(hn::Set(d, kShiftColumns), as_double(sums.squares));
    for (const auto& row : sums.of_row) variance = hn::Sub(variance, hn::Mul(as_double(row), as_double(row)));
    const auto right_variance = hn::Add(hn::Mul(variance, hn::Set(d, 1.0 / (kScale * kScale))), hn::Set(d, noise));
    const auto square = hn::Mul(left_variance, right_variance);
    const auto value = hn::Div(as_double(sums.covariance), hn::Mul(hn::Set(d, kScale), hn::Sqrt(square)));
    const auto known = hn::IfThenElseZero(hn::Gt(square, hn::Zero(d)), value);
    hn::Store(hn::DemoteTo(d_float, known), d_float, result + s);
  }
  std::copy_n(result, shifts, coefficient);
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(CorrelateShifts);

void correlate_shifts(const ShiftedPatches& patches, float* coefficient) {
  HWY_DYNAMIC_DISPATCH(CorrelateShifts)(patches, coefficient);
}

}  // namespace flies::kernels
#endif
