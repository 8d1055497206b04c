// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation. It is
// compiled without contraction of products and sums, which would round differently where the CPU can fuse them.
#include "flies/concentrate/kernels/kernel_sums.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/concentrate/kernels/kernel_sums.cpp"
// Vectors without a compile-time size: they cannot be held in arrays.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Points are added up in eight sums, whatever the width of a vector, so that results do not depend on it.
constexpr std::size_t kLanes = 8;
static_assert(kLanes <= kPadding);

using D = hn::CappedTag<double, kLanes>;
using V = hn::Vec<D>;
constexpr std::size_t kVectors = kLanes / hn::MaxLanes(D());

/// The kernel's exponent lies in [-2 kMiddle, 0]. From its middle it is at most kMiddle, of which the 16th part is
/// small enough for ten terms of Taylor's series. Four squarings raise the result again.
constexpr double kMiddle = 0.25 * kKernelReach * kKernelReach;
constexpr double kExpOfMinusMiddle = 0.10539922456186433;
constexpr double kParts = 16.0;

/// exp(kParts * part)
HWY_INLINE V raised_exp(V part) {
  const D d;
  V sum = hn::Set(d, 1.0 / 362880.0);
  for (const double coefficient :
       {1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0})
    sum = hn::Add(hn::Mul(sum, part), hn::Set(d, coefficient));
  for (int squaring = 0; squaring < 4; ++squaring) sum = hn::Mul(sum, sum);
  return sum;
}

/// The sum of eight lanes, in one order.
HWY_INLINE double total(const V* vectors) {
  HWY_ALIGN double lanes[kLanes];
  for (std::size_t k = 0; k < kVectors; ++k) hn::Store(vectors[k], D(), lanes + k * hn::MaxLanes(D()));
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

HWY_ATTR KernelSums SumKernel(const PointRuns& points, double u_px, double v_px, double bandwidth_px) {
  const D d;
  const V u = hn::Set(d, u_px), v = hn::Set(d, v_px);
  const double per_px2 = 0.5 / (bandwidth_px * bandwidth_px);
  const V part_per_px2 = hn::Set(d, per_px2 / kParts), middle = hn::Set(d, kMiddle / kParts);
  const V reach_px2 = hn::Set(d, kKernelReach * kKernelReach * bandwidth_px * bandwidth_px);
  V weight[kVectors], weighted_du[kVectors], weighted_dv[kVectors];
  for (std::size_t k = 0; k < kVectors; ++k) weight[k] = weighted_du[k] = weighted_dv[k] = hn::Zero(d);
  for (std::size_t run = 0; run < points.runs; ++run) {
    const std::size_t begin = points.starts[run * points.stride];
    const std::size_t end = points.starts[run * points.stride + points.cells];
    for (std::size_t i = begin; i < end; i += kLanes)
      for (std::size_t k = 0; k < kVectors; ++k) {
        const std::size_t first = i + k * hn::MaxLanes(d);
        const V du = hn::Sub(hn::LoadU(d, points.u_px + first), u);
        const V dv = hn::Sub(hn::LoadU(d, points.v_px + first), v);
        const V px2 = hn::Add(hn::Mul(du, du), hn::Mul(dv, dv));
        const auto counts = hn::And(hn::Le(px2, reach_px2), hn::FirstN(d, end > first ? end - first : 0));
        const V kernel = raised_exp(hn::Sub(middle, hn::Mul(px2, part_per_px2)));
        const V w = hn::IfThenElseZero(counts, hn::Mul(hn::LoadU(d, points.weight + first), kernel));
        weight[k] = hn::Add(weight[k], w);
        weighted_du[k] = hn::Add(weighted_du[k], hn::Mul(w, du));
        weighted_dv[k] = hn::Add(weighted_dv[k], hn::Mul(w, dv));
      }
  }
  return {kExpOfMinusMiddle * total(weight), kExpOfMinusMiddle * total(weighted_du),
          kExpOfMinusMiddle * total(weighted_dv)};
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(SumKernel);

KernelSums sum_kernel(const PointRuns& points, double u_px, double v_px, double bandwidth_px) {
  return HWY_DYNAMIC_DISPATCH(SumKernel)(points, u_px, v_px, bandwidth_px);
}

}  // namespace flies::kernels
#endif
