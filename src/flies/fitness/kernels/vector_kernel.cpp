// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation.
#include "flies/fitness/kernels/vector_kernel.hpp"

#include <cstring>
#include <iterator>

#include "flies/fitness/kernels/mean_agreement.hpp"

// Vectors without a compile-time size: a patch is too narrow to gain from them, NEON serves it as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/fitness/kernels/vector_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "flies/fitness/kernels/row_vectors-inl.hpp"
// After the vectors it is made of.
#include "flies/fitness/kernels/agreement-inl.hpp"
#include "flies/fitness/kernels/byte_products-inl.hpp"
#include "flies/fitness/kernels/four_patches-inl.hpp"
#include "flies/fitness/kernels/patch_reader-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR

const Kernel& kernel() { return scalar_kernel(); }

#else

/// Adds neighbouring lanes that are not negative and exact modulo 2^32.
HWY_INLINE V64 widen_unsigned(V32 v) {
  const D64 d;
  const V64 pairs = hn::BitCast(d, v);
  return hn::Add(hn::And(pairs, hn::Set(d, 0xFFFFFFFF)),
                 hn::BitCast(d, hn::ShiftRight<32>(hn::BitCast(DU64(), pairs))));
}

/// Loads what was just stored block by block: one load of several stores would have to wait for them.
HWY_INLINE V16 load_stored_blocks(const std::uint16_t* from) {
  const auto* const lanes = reinterpret_cast<const std::int16_t*>(from);
#if HWY_MAX_BYTES >= 32
  const hn::Half<D16> half;
  return hn::Combine(D16(), hn::Load(half, lanes + 8), hn::Load(half, lanes));
#else
  return hn::Load(D16(), lanes);
#endif
}

/// Sums of products over a patch. At most 4 columns of a chunk end in the same 32-bit lane, which is exact modulo 2^32.
template <int kChunks>
struct MomentSums {
  Sum lr, ll, rr[kChunks];

  HWY_INLINE MomentSums() {}

  /// @param buffer  rows behind the last one hold the biases
  HWY_INLINE PatchMoments centre(const RowBuffer<1>& buffer, int rows, std::int64_t columns) const {
    // Up to 15 columns: the sums of l l and of l r over the whole patch fit 32 bits, too.
    const std::int64_t l_bias = left_bias(static_cast<int>(columns)), r_bias = right_bias(static_cast<int>(columns));
    const D16 d;
    const V16 l_bias_lanes = hn::Set(d, static_cast<std::int16_t>(l_bias));
    const V16 r_bias_lanes = hn::Set(d, static_cast<std::int16_t>(r_bias)), one = hn::Set(d, 1);
    Sum row_lr, row_ll, row_l, row_r;
    V64 row_rr = hn::Zero(D64());
    for (int j = 0; j < rows; j += static_cast<int>(hn::MaxLanes(d))) {
      const V16 l = hn::Sub(load_stored_blocks(buffer.l[0] + j), l_bias_lanes);
      const V16 r = hn::Sub(load_stored_blocks(buffer.r[0] + j), r_bias_lanes);
      row_lr.add_products(l, r);
      row_ll.add_products(l, l);
      row_l.add_products(l, one);
      row_r.add_products(r, one);
      Sum squares;
      squares.add_products(r, r);
      row_rr = hn::Add(row_rr, widen_unsigned(squares.total()));
    }
    alignas(32) std::int32_t products[hn::MaxLanes(D32())], sums[hn::MaxLanes(D32())];
    alignas(32) std::int64_t squares[hn::MaxLanes(D64())];
    hn::Store(fold<std::int64_t>(fold<std::int32_t>(lr.total(), ll.total()),
                                 fold<std::int32_t>(row_lr.total(), row_ll.total())),
              D32(), products);
    hn::Store(fold<std::int32_t>(row_l.total(), row_r.total()), D32(), sums);
    hn::Store(fold<std::int64_t>(widen_unsigned(rr[0].total()), row_rr), D64(), squares);
    std::int64_t lr_sum = products[0], ll_sum = products[1], row_lr_sum = products[2], row_ll_sum = products[3];
    std::int64_t row_l_sum = sums[0] + sums[2], row_r_sum = sums[1] + sums[3];
    std::int64_t rr_sum = squares[0], row_rr_sum = squares[1];
    if constexpr (kBlocks == 2) {
      lr_sum += products[4];
      ll_sum += products[5];
      row_lr_sum += products[6];
      row_ll_sum += products[7];
      row_l_sum += sums[4] + sums[6];
      row_r_sum += sums[5] + sums[7];
      rr_sum += squares[2];
      row_rr_sum += squares[3];
    }
    return {.lr = columns * lr_sum - (row_lr_sum + l_bias * row_r_sum + r_bias * row_l_sum + rows * l_bias * r_bias),
            .ll = columns * ll_sum - (row_ll_sum + 2 * l_bias * row_l_sum + rows * l_bias * l_bias),
            .rr = columns * rr_sum - (row_rr_sum + 2 * r_bias * row_r_sum + rows * r_bias * r_bias)};
  }

  HWY_INLINE PatchMoments centre(const RowBuffer<2>& buffer, int rows, std::int64_t columns) const {
    PatchMoments moments = {columns * sum_lanes(widen_unsigned(lr.total())),
                            columns * sum_lanes(widen_unsigned(ll.total())),
                            columns * sum_lanes(hn::Add(widen_unsigned(rr[0].total()), widen_unsigned(rr[1].total())))};
    for (int j = 0; j < rows; ++j) {
      const std::int64_t l = buffer.l[0][j] + buffer.l[1][j], r = buffer.r[0][j] + buffer.r[1][j];
      moments.lr -= l * r;
      moments.ll -= l * l;
      moments.rr -= r * r;
    }
    return moments;
  }

 private:
  static HWY_INLINE std::int64_t sum_lanes(V64 v) { return hn::GetLane(hn::SumOfLanes(D64(), v)); }
};

/// Reads a patch row by row: calls `take_columns`(c, l, r) with the vectors of each row and chunk, then `end_row`(its
/// number).
template <int kChunks, class TakeColumns, class EndRow>
HWY_INLINE void read_rows(const Patch<kChunks>& patch, int rows, TakeColumns&& take_columns, EndRow&& end_row) {
  const std::uint8_t *left = patch.left, *right = patch.right;
  for (int j = 0; j < rows; ++j) {
    patch.read_row(left, right, take_columns);
    end_row(j, left, right);
    left += patch.left_stride;
    right += patch.right_stride;
  }
}

template <int kChunks>
struct MomentsKernel {
  using Result = PatchMoments;
  RowBuffer<kChunks> buffer;

  HWY_INLINE MomentsKernel(int rows, int columns) {
    for (int c = 0; c < kChunks; ++c)
      for (int j = rows; j < kRowCapacity; ++j) {
        buffer.lanes[c][j][0] = static_cast<std::int16_t>(buffer.l[c][j] = left_bias(columns));
        buffer.lanes[c][j][8] = static_cast<std::int16_t>(buffer.r[c][j] = right_bias(columns));
      }
  }
  HWY_INLINE PatchMoments operator()(const Patch<kChunks>& patch, int rows, int columns) {
    MomentSums<kChunks> sums;
    const auto take = [&](int c, V16 l, V16 r) HWY_ATTR {
      sums.lr.add_products(l, r);
      sums.ll.add_products(l, l);
      sums.rr[c].add_products(r, r);
    };
    read_rows(patch, rows, take, [&](int j, const std::uint8_t* left, const std::uint8_t* right) HWY_ATTR {
      for (int c = 0; c < kChunks; ++c) patch.sum_columns(left, right, c, buffer.lanes[c][j]);
    });
    buffer.add_lanes(rows);
    return sums.centre(buffer, rows, columns);
  }
};

template <int kChunks>
struct WeightedCovarianceKernel {
  using Result = float;
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D32()));
  RowBuffer<kChunks> buffer;
  alignas(32) std::int32_t lr_lanes[kRowCapacity][kLanes] = {};
  Agreement<DF> agreement;

  HWY_INLINE WeightedCovarianceKernel(int, int columns) : agreement(columns) {}
  HWY_INLINE float operator()(const Patch<kChunks>& patch, int rows, int columns) {
    Sum lr;
    read_rows(
        patch, rows, [&](int, V16 l, V16 r) HWY_ATTR { lr.add_products(l, r); },
        [&](int j, const std::uint8_t* left, const std::uint8_t* right) HWY_ATTR {
          for (int c = 0; c < kChunks; ++c) patch.sum_columns(left, right, c, buffer.lanes[c][j]);
          hn::Store(lr.total(), D32(), lr_lanes[j]);
          lr = Sum();
        });
    buffer.add_lanes(rows);

    const D32 d;
    const V32 n = hn::Set(d, columns);
    // Of the rows with equal number modulo 8: one order of summation for all instruction sets.
    VF part[kParts];
    for (int p = 0; p < kParts; ++p) part[p] = hn::Zero(DF());
    for (int j = 0; j < rows; j += kRowsAtOnce)
      for (int p = 0; p < kParts; ++p) {
        const V32 l = widen(buffer.l, j + p * kLanes), r = widen(buffer.r, j + p * kLanes);
        const V32 C = hn::Sub(hn::Mul(n, add_lr_lanes(j + p * kLanes)), hn::Mul(l, r));
        const V32 difference = hn::Abs(hn::Sub(hn::ShiftLeft<4>(l), r));
        part[p] = hn::Add(part[p], hn::Mul(hn::ConvertTo(DF(), C), agreement(difference)));
      }
    alignas(32) float sums[kRowsAtOnce];
    for (int p = 0; p < kParts; ++p) hn::Store(part[p], DF(), sums + p * kLanes);
    const float even = (sums[0] + sums[4]) + (sums[2] + sums[6]), odd = (sums[1] + sums[5]) + (sums[3] + sums[7]);
    return (even + odd) / static_cast<float>(kScale * columns);
  }

 private:
  /// 8 or 4 sums of rows from row `j` on, in 32 bits.
  static HWY_INLINE V32 widen(const std::uint16_t (&sums)[kChunks][kRowCapacity], int j) {
    const hn::Rebind<std::uint16_t, D32> narrow;
    V32 total = hn::PromoteTo(D32(), hn::Load(narrow, sums[0] + j));
    if constexpr (kChunks == 2) total = hn::Add(total, hn::PromoteTo(D32(), hn::Load(narrow, sums[1] + j)));
    return total;
  }
  HWY_INLINE V32 add_lr_lanes(int j) const {
    const D32 d;
    const auto quad = [&](int k) HWY_ATTR {
      const V32 r01 = fold<std::int32_t>(hn::Load(d, lr_lanes[k]), hn::Load(d, lr_lanes[k + 1]));
      const V32 r23 = fold<std::int32_t>(hn::Load(d, lr_lanes[k + 2]), hn::Load(d, lr_lanes[k + 3]));
      return fold<std::int64_t>(r01, r23);
    };
#if HWY_MAX_BYTES >= 32
    const V32 upper = quad(j), lower = quad(j + 4);
    return hn::Add(hn::ConcatLowerLower(d, lower, upper), hn::ConcatUpperUpper(d, lower, upper));
#else
    return quad(j);
#endif
  }
};

template <int kChunks>
struct SquaredDifferencesKernel {
  using Result = std::int64_t;

  HWY_INLINE SquaredDifferencesKernel(int, int) {}
  HWY_INLINE std::int64_t operator()(const Patch<kChunks>& patch, int rows, int) {
    Sum squares[kChunks];  // at most 4 columns of each end in the same 32-bit lane, which is exact modulo 2^32
    const auto take = [&](int c, V16 l, V16 r) HWY_ATTR {
      const V16 difference = hn::Sub(hn::ShiftLeft<4>(l), r);
      squares[c].add_products(difference, difference);
    };
    read_rows(patch, rows, take, [](int, const std::uint8_t*, const std::uint8_t*) HWY_ATTR {});
    V64 total = widen_unsigned(squares[0].total());
    if constexpr (kChunks == 2) total = hn::Add(total, widen_unsigned(squares[1].total()));
    return hn::GetLane(hn::SumOfLanes(D64(), total));
  }
};

/// A copy of a patch whose vectors would reach behind the end of an image.
struct PatchCopy {
  static constexpr int kStride = 32;
  std::uint8_t left[kMaxRows * kStride], right[kMaxRows * kStride];

  HWY_INLINE void copy(const PatchImages& images, const PatchPlace& place) {
    const auto columns = static_cast<std::size_t>(images.columns),
               next = static_cast<std::size_t>(place.fraction16 != 0);
    for (int j = 0; j < images.rows; ++j) {
      std::memcpy(left + j * kStride, place.left + j * images.left_stride, columns);
      std::memcpy(right + j * kStride, place.right + j * images.right_stride, columns + next);
    }
  }
};

template <class Kernel, int kChunks>
HWY_INLINE void evaluate(const PatchImages& images, int rows, int columns, std::span<const PatchPlace> places,
                         typename Kernel::Result* results) {
  constexpr std::ptrdiff_t kReach = 16 + (kChunks - 1) * kFirstChunk;
  const auto reaches_beyond = [&](const std::uint8_t* first, std::ptrdiff_t stride, const std::uint8_t* end)
                                  HWY_ATTR { return end - first < (rows - 1) * stride + kReach; };
  Patch<kChunks> patch(columns);
  Kernel kernel(rows, columns);
  PatchCopy copy;
  for (const PatchPlace& place : places) {
    patch.left = place.left;
    patch.right = place.right;
    patch.left_stride = images.left_stride;
    patch.right_stride = images.right_stride;
    if (reaches_beyond(place.left, images.left_stride, images.left_end) ||
        reaches_beyond(place.right, images.right_stride, images.right_end)) {
      copy.copy(images, place);
      patch.left = copy.left;
      patch.right = copy.right;
      patch.left_stride = patch.right_stride = PatchCopy::kStride;
    }
    patch.set_fraction(place.fraction16);
    *results++ = kernel(patch, rows, columns);
  }
}

template <template <int> class Kernel>
void evaluate_all(const PatchImages& images, std::span<const PatchPlace> places, typename Kernel<1>::Result* results) {
  if (images.columns == kUsualColumns && images.rows == kUsualRows)
    evaluate<Kernel<1>, 1>(images, kUsualRows, kUsualColumns, places, results);
  else if (images.columns == kUsualColumns && images.rows == kUsualFewRows)
    evaluate<Kernel<1>, 1>(images, kUsualFewRows, kUsualColumns, places, results);
  else if (images.columns <= kChunkColumns)
    evaluate<Kernel<1>, 1>(images, images.rows, images.columns, places, results);
  else
    evaluate<Kernel<2>, 2>(images, images.rows, images.columns, places, results);
}

const Kernel& kernel() {
  static const Kernel kernel = {hwy::TargetName(HWY_TARGET), evaluate_all<SquaredDifferencesKernel>,
                                evaluate_all<WeightedCovarianceKernel>, evaluate_all<MomentsKernel>};
  return kernel;
}

#if HWY_TARGET == HWY_AVX3

const Kernel& four_patches_kernel() {
  static const Kernel kernel = {"AVX3_DL", evaluate_all<SquaredDifferencesKernel>,
                                evaluate_fours<FourWeightedCovariances, evaluate_all<WeightedCovarianceKernel> >,
                                evaluate_fours<FourMoments, evaluate_all<MomentsKernel> >};
  return kernel;
}

#endif  // HWY_TARGET == HWY_AVX3

#endif  // HWY_TARGET == HWY_SCALAR
}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {
namespace {

HWY_EXPORT(kernel);

Kernel kernel_for([[maybe_unused]] std::int64_t target) {
#if (HWY_TARGETS & (HWY_TARGETS - 1)) == 0
  return HWY_STATIC_DISPATCH(kernel)();
#else
  // A choice of our own: the one inside Highway is shared with every other library of the process.
  hwy::ChosenTarget choice;
  choice.Update(target);
  return HWY_DISPATCH_TABLE(kernel)[choice.GetIndex()]();
#endif
}

}  // namespace

std::vector<Kernel> vector_kernels() {
  std::vector<Kernel> kernels;
#if HWY_TARGETS & HWY_AVX3
  if ((hwy::SupportedTargets() & HWY_AVX3) != 0 && __builtin_cpu_supports("avx512vnni") != 0 &&
      __builtin_cpu_supports("avx512vbmi2") != 0)
    kernels.push_back(N_AVX3::four_patches_kernel());
#endif
  // Highway lists the better ones first.
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
    if (target != HWY_SCALAR) kernels.push_back(kernel_for(target));
  return kernels;
}

}  // namespace flies::kernels
#endif  // HWY_ONCE
