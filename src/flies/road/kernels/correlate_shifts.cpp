// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation. It is
// compiled without contraction of products and sums, which would round differently where the CPU can fuse them.
#include "flies/road/kernels/correlate_shifts.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/road/kernels/correlate_shifts.cpp"
// Vectors without a compile-time size: the last ones could reach beyond the strips.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D32 = hn::CappedTag<std::int32_t, 16>;
using D64 = hn::CappedTag<double, 8>;

/// Grey levels of the right image are multiplied by this, which makes them integers.
constexpr int kScale = kShiftSteps;

constexpr std::size_t kColumns = kShiftColumns, kRows = kShiftRows;
constexpr std::size_t kPaddedShifts = kMaxShifts + 16;
constexpr std::size_t kStrip = kPaddedShifts + kColumns;

/// What is known after one pass over the images. Sums over a row are exact integers; those over the neighbourhood too:
/// a covariance times the square of the columns stays below 25^2 / 4 * 255 * (16 * 255) in each row, which five rows
/// make 8e8, whatever wraps around on the way.
struct Sums {
  /// Of each left row n l - (sum l), which centres the row that it is multiplied with, too.
  std::int32_t centred_left[kRows][kColumns];
  double left_variance = 0.0;
  HWY_ALIGN std::int32_t right[kRows][kStrip] = {};
  HWY_ALIGN double right_variance[kPaddedShifts] = {};
};

HWY_INLINE void sum_left(const ShiftedPatches& patches, Sums& sums) {
  for (std::size_t row = 0; row < kRows; ++row) {
    const std::uint8_t* l = patches.left + static_cast<std::ptrdiff_t>(row) * patches.left_stride;
    std::int32_t sum = 0, squares = 0;
    for (std::size_t i = 0; i < kColumns; ++i) {
      sum += l[i];
      squares += l[i] * l[i];
    }
    for (std::size_t i = 0; i < kColumns; ++i) sums.centred_left[row][i] = kShiftColumns * l[i] - sum;
    sums.left_variance += kShiftColumns * squares - sum * sum;
  }
}

HWY_INLINE void sum_right(const ShiftedPatches& patches, Sums& sums) {
  const auto shifts = static_cast<std::size_t>(patches.shifts);
  for (std::size_t row = 0; row < kRows; ++row) {
    const std::uint8_t* pixel = patches.right + static_cast<std::ptrdiff_t>(row) * patches.right_stride;
    std::int32_t* r = sums.right[row];
    for (std::size_t i = 0; i < shifts + kColumns - 1; ++i)
      r[i] = kScale * pixel[i] + patches.fraction16 * (pixel[i + 1] - pixel[i]);
    // Window sums slide.
    std::int32_t sum = 0, squares = 0;
    for (std::size_t i = 0; i < kColumns - 1; ++i) {
      sum += r[i];
      squares += r[i] * r[i];
    }
    for (std::size_t s = 0; s < shifts; ++s) {
      const std::int32_t first = r[s], last = r[s + kColumns - 1];
      sum += last;
      squares += last * last;
      sums.right_variance[s] += static_cast<double>(kShiftColumns * static_cast<std::int64_t>(squares) -
                                                    static_cast<std::int64_t>(sum) * sum);
      sum -= first;
      squares -= first * first;
    }
  }
}

HWY_ATTR void CorrelateShifts(const ShiftedPatches& patches, float* coefficient) {
  const D32 d;
  const D64 d64;
  const hn::Rebind<std::int32_t, D64> d_half;
  const hn::Rebind<float, D64> d_float;
  Sums sums;
  sum_left(patches, sums);
  sum_right(patches, sums);
  HWY_ALIGN std::int32_t covariance[kPaddedShifts];
  HWY_ALIGN float result[kPaddedShifts];
  const auto shifts = static_cast<std::size_t>(patches.shifts);
  for (std::size_t s = 0; s < shifts; s += hn::MaxLanes(d)) {
    auto sum = hn::Zero(d);
    for (std::size_t row = 0; row < kRows; ++row)
      for (std::size_t i = 0; i < kColumns; ++i)
        sum = hn::Add(sum, hn::Mul(hn::Set(d, sums.centred_left[row][i]), hn::LoadU(d, sums.right[row] + s + i)));
    hn::Store(sum, d, covariance + s);
  }
  const double noise = kShiftRows * kShiftColumns * kShiftColumns * patches.noise_gray2;
  const auto left = hn::Set(d64, sums.left_variance + noise);
  for (std::size_t s = 0; s < shifts; s += hn::MaxLanes(d64)) {
    const auto lr = hn::PromoteTo(d64, hn::Load(d_half, covariance + s));
    const auto rr = hn::Mul(hn::Load(d64, sums.right_variance + s), hn::Set(d64, 1.0 / (kScale * kScale)));
    const auto square = hn::Mul(left, hn::Add(rr, hn::Set(d64, noise)));
    const auto value = hn::Div(lr, hn::Mul(hn::Set(d64, kScale), hn::Sqrt(square)));
    const auto known = hn::IfThenElseZero(hn::Gt(square, hn::Zero(d64)), value);
    hn::Store(hn::DemoteTo(d_float, known), d_float, result + s);
  }
  for (std::size_t s = 0; s < shifts; ++s) coefficient[s] = result[s];
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
