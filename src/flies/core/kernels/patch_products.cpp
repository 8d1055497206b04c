// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation.
#include "flies/core/kernels/patch_products.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/core/kernels/patch_products.cpp"
// Vectors without a compile-time size: a row of a patch may be shorter than they are.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE std::int32_t product_at(const PatchRow& row, int place) {
  std::int32_t sum = 0;
  for (int j = 0; j < kProductRows; ++j)
    for (int i = 0; i < kProductColumns; ++i)
      sum += row.patch[j * row.patch_stride + i] * row.others[j * row.others_stride + place + i];
  return sum;
}

#else

HWY_INLINE std::int32_t product_at(const PatchRow& row, int place) {
  const hn::CappedTag<std::int16_t, kProductColumns> d16;
  const hn::RepartitionToWide<decltype(d16)> d32;
  auto some = hn::Zero(d32), others = hn::Zero(d32);
  for (int j = 0; j < kProductRows; ++j)
    for (std::size_t i = 0; i < kProductColumns; i += hn::MaxLanes(d16)) {
      const auto a = hn::LoadU(d16, row.patch + j * row.patch_stride + i);
      const auto b = hn::LoadU(d16, row.others + j * row.others_stride + place + i);
      some = hn::ReorderWidenMulAccumulate(d32, a, b, some, others);
    }
  return hn::GetLane(hn::SumOfLanes(d32, hn::Add(some, others)));
}

#endif

HWY_ATTR void PatchProducts(const PatchRow& row, std::int32_t* product) {
  for (int place = 0; place < row.places; ++place) product[place] = product_at(row, place);
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(PatchProducts);

void patch_products(const PatchRow& row, std::int32_t* product) { HWY_DYNAMIC_DISPATCH(PatchProducts)(row, product); }

}  // namespace flies::kernels
#endif
