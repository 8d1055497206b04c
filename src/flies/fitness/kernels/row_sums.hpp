#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "flies/fitness/kernels/patch_kernel.hpp"

namespace flies::kernels {

constexpr int kScale = 16;       ///< sub-pixel steps, also the scale of the right neighbourhood's grey levels
constexpr int kMaxColumns = 25;  ///< of a patch
constexpr int kMaxRows = 33;     ///< of a patch

/// Sums over each row of a patch, l a grey level of the left and r 16 times one of the right neighbourhood. Exact.
struct RowSums {
  /// Rows a kernel may write, the last ones with 0: it takes four at a time.
  static constexpr int kCapacity = 36;
  std::array<std::int32_t, kCapacity> l, r, lr;
  std::int64_t ll, rr;  ///< over all rows; only sum_rows_and_squares sets them
};

/// The integer part of the fitness functions for one instruction set. All kernels give the same numbers.
struct RowSumsKernel {
  std::string_view target;  ///< "scalar" or Highway's name of the instruction set: SSE4, AVX2, AVX3 (AVX-512), NEON
  void (*sum_rows)(const PatchPair& patch, RowSums& sums);
  void (*sum_rows_and_squares)(const PatchPair& patch, RowSums& sums);
  std::int64_t (*sum_squared_differences)(const PatchPair& patch);
};

/// Plain loops: the yardstick of the others, and what runs where there are no vectors.
const RowSumsKernel& scalar_kernel();

/// The kernels this CPU can run, fastest first, `scalar_kernel()` last.
std::span<const RowSumsKernel> supported_kernels();

/// The kernel called `wanted` in upper or lower case, or the fastest when this CPU runs none of that name.
const RowSumsKernel& select_kernel(std::string_view wanted);

/// What the environment variable FLIES_TARGET selects, read at the first call.
const RowSumsKernel& chosen_kernel();

/// The functions of patch_kernel.hpp by a given kernel.
std::int64_t sum_squared_differences(const PatchPair& patch, const RowSumsKernel& kernel);
double sum_weighted_covariance(const PatchPair& patch, const RowSumsKernel& kernel);
RowCentredMoments sum_row_centred_moments(const PatchPair& patch, const RowSumsKernel& kernel);

}  // namespace flies::kernels
