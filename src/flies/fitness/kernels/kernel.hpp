#pragma once

#include <span>
#include <string_view>

#include "flies/fitness/kernels/patch.hpp"

namespace flies::kernels {

/// The fitness functions up to their last few operations, for one instruction set; each evaluates many patches. All
/// kernels give the same numbers: sums are exact integers, and what floating point there is has one order.
struct Kernel {
  std::string_view target;  ///< "scalar" or Highway's name of the instruction set: SSE4, AVX2, AVX3 (AVX-512), NEON;
                            ///< AVX3_DL: AVX-512 with VNNI and VBMI2

  /// Denominator of Eq. (1): summed squared differences in (1/16 grey level)^2.
  void (*sum_squared_differences)(const PatchImages& images, std::span<const PatchPlace> places, std::int64_t* sums);

  /// Eq. (2), sums over the rows of covariance times exp(-|difference of row means|); may be negative. To 4e-7 of the
  /// sum of the absolute terms, were it not for the precision of exp that mean_agreement.hpp states.
  void (*sum_weighted_covariances)(const PatchImages& images, std::span<const PatchPlace> places, float* sums);

  void (*sum_moments)(const PatchImages& images, std::span<const PatchPlace> places, PatchMoments* moments);
};

/// Plain loops: the yardstick of the others, and what runs where there are no vectors.
const Kernel& scalar_kernel();

/// The kernels this CPU can run, fastest first, `scalar_kernel()` last.
std::span<const Kernel> supported_kernels();

/// The kernel called `wanted` in upper or lower case, or the fastest when this CPU runs none of that name.
const Kernel& select_kernel(std::string_view wanted);

/// What the environment variable FLIES_TARGET selects, read at the first call.
const Kernel& chosen_kernel();

}  // namespace flies::kernels
