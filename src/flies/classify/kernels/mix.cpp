// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation.
#include "flies/classify/kernels/mix.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/classify/kernels/mix.cpp"
// Vectors without a compile-time size, which NEON serves as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kMixedColumns>;
using D4 = hn::CappedTag<float, kMixedRows>;
constexpr std::size_t kLanes = hn::MaxLanes(D()), kLanes4 = hn::MaxLanes(D4());

HWY_ATTR void MixRows(const std::uint8_t* const* rows, const float* weights, std::size_t taps, std::size_t columns,
                      float* mixed) {
  const D d;
  const hn::Rebind<std::int32_t, D> whole;
  const hn::Rebind<std::uint8_t, D> byte;
  std::size_t u = 0;
  for (; u + kLanes <= columns; u += kLanes) {
    hn::Vec<D> sums[kMixedRows];
    for (std::size_t r = 0; r < kMixedRows; ++r) {
      sums[r] = hn::Zero(d);
      for (std::size_t t = r * taps; t < (r + 1) * taps; ++t) {
        const auto levels = hn::ConvertTo(d, hn::PromoteTo(whole, hn::LoadU(byte, rows[t] + u)));
        sums[r] = hn::Add(sums[r], hn::Mul(levels, hn::Set(d, weights[t])));
      }
    }
    hn::StoreInterleaved4(sums[0], sums[1], sums[2], sums[3], d, mixed + kMixedRows * u);
  }
  for (; u < columns; ++u) {  // no pixel behind the last one is read: the image may end there
    for (std::size_t r = 0; r < kMixedRows; ++r) {
      float sum = 0.0F;
      for (std::size_t t = r * taps; t < (r + 1) * taps; ++t) sum += static_cast<float>(rows[t][u]) * weights[t];
      mixed[kMixedRows * u + r] = sum;
    }
  }
}

template <std::size_t kTaps>
HWY_ATTR void mix_columns(const float* mixed, const int* source, const float* weights, std::size_t width,
                          float* aside) {
  const D4 d;
  for (std::size_t u = 0; u < width; ++u, source += kTaps, weights += kTaps, aside += kMixedRows) {
    for (std::size_t r = 0; r < kMixedRows; r += kLanes4) {
      auto sum = hn::Zero(d);
      for (std::size_t t = 0; t < kTaps; ++t)
        sum = hn::Add(sum, hn::Mul(hn::LoadU(d, mixed + kMixedRows * static_cast<std::size_t>(source[t]) + r),
                                   hn::Set(d, weights[t])));
      hn::StoreU(sum, d, aside + r);
    }
  }
}

HWY_ATTR void MixColumns(const float* mixed, const int* source, const float* weights, std::size_t taps,
                         std::size_t width, float* aside, const std::array<float*, kMixedRows>& rows) {
  const D d;
  const D4 d4;
  if (taps == 2) {
    mix_columns<2>(mixed, source, weights, width, aside);
  } else if (taps == 3) {
    mix_columns<3>(mixed, source, weights, width, aside);
  } else {
    for (std::size_t u = 0; u < width; ++u)
      for (std::size_t r = 0; r < kMixedRows; r += kLanes4) {
        auto sum = hn::Zero(d4);
        for (std::size_t t = u * taps; t < (u + 1) * taps; ++t)
          sum = hn::Add(sum, hn::Mul(hn::LoadU(d4, mixed + kMixedRows * static_cast<std::size_t>(source[t]) + r),
                                     hn::Set(d4, weights[t])));
        hn::StoreU(sum, d4, aside + kMixedRows * u + r);
      }
  }
  std::size_t u = 0;
  for (; u + kLanes <= width; u += kLanes) {
    hn::Vec<D> row[kMixedRows];
    hn::LoadInterleaved4(d, aside + kMixedRows * u, row[0], row[1], row[2], row[3]);
    for (std::size_t r = 0; r < kMixedRows; ++r) hn::StoreU(row[r], d, rows[r] + u);
  }
  for (; u < width; ++u)
    for (std::size_t r = 0; r < kMixedRows; ++r) rows[r][u] = aside[kMixedRows * u + r];
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(MixRows);
HWY_EXPORT(MixColumns);

void mix_rows(const std::uint8_t* const* rows, const float* weights, std::size_t taps, std::size_t columns,
              float* mixed) {
  HWY_DYNAMIC_DISPATCH(MixRows)(rows, weights, taps, columns, mixed);
}

void mix_columns(const float* mixed, const Taps& taps, std::size_t width, float* aside,
                 const std::array<float*, kMixedRows>& rows) {
  HWY_DYNAMIC_DISPATCH(MixColumns)
  (mixed, taps.source.data(), taps.weights.data(), taps.count, width, aside, rows);
}

}  // namespace flies::kernels
#endif
