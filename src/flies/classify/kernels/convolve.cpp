// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation.
#include "flies/classify/kernels/convolve.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "flies/fitness/kernels/kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/classify/kernels/convolve.cpp"
// Vectors without a compile-time size, which NEON serves as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "flies/fitness/kernels/byte_products-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

void Convolve(const Convolution& c, const std::int16_t* input, std::size_t input_row, std::int16_t* output,
              std::size_t output_row) {
  const std::size_t pixel = 2 * c.pairs;
  for (std::size_t v = 0; v < c.height; ++v)
    for (std::size_t u = 0; u < c.width; ++u)
      for (std::size_t o = 0; o < c.outputs; ++o) {
        std::int32_t sum = 0;
        const std::int16_t* weights = c.weights + 2 * o;
        for (std::size_t row = 0; row < 3; ++row) {
          const std::int16_t* source = input + (v * c.stride + row) * input_row + u * c.stride * pixel;
          for (std::size_t i = 0; i < 3 * pixel; i += 2, weights += 2 * c.outputs)
            sum += source[i] * weights[0] + source[i + 1] * weights[1];
        }
        const float level = static_cast<float>(sum) * c.scale[o] + c.offset[o];
        output[v * output_row + u * c.outputs + o] =
            static_cast<std::int16_t>(std::nearbyint(std::min(std::max(level, 0.0F), kMostActive)));
      }
}

#else

using D32 = hn::CappedTag<std::int32_t, kConvolutionLanes>;
using D16 = hn::Repartition<std::int16_t, D32>;
using D16Half = hn::Rebind<std::int16_t, D32>;
using DFloat = hn::Rebind<float, D32>;
constexpr std::size_t kLanes = hn::MaxLanes(D32());
constexpr bool kHasManyRegisters = kLanes == 16;

/// Sums of products of pairs of whole numbers, those of two neighbours in one.
class PairSums {
 public:
  HWY_INLINE PairSums() : sums_(hn::Zero(D32())), others_(hn::Zero(D32())) {}
  HWY_INLINE void add(hn::Vec<D16> a, hn::Vec<D16> b) {
    sums_ = hn::ReorderWidenMulAccumulate(D32(), a, b, sums_, others_);
  }
  HWY_INLINE hn::Vec<D32> total() const { return hn::RearrangeToOddPlusEven(sums_, others_); }

 private:
  hn::Vec<D32> sums_, others_;
};

/// `kPixels` neighbours of a row, `kVectors` vectors of channels from `first` on: what stays in registers.
template <std::size_t kPixels, std::size_t kVectors, class Sums>
HWY_INLINE void block(const Convolution& c, const std::int16_t* input, std::size_t input_row, std::size_t first,
                      std::int16_t* output) {
  const D32 d32;
  const D16 d16;
  Sums sums[kPixels][kVectors];
  const std::size_t pixel = 2 * c.pairs;
  const std::int16_t* weights = c.weights + 2 * first;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column) {
      const std::int16_t* source = input + row * input_row + column * pixel;
      for (std::size_t pair = 0; pair < c.pairs; ++pair, source += 2, weights += 2 * c.outputs) {
        hn::Vec<D16> w[kVectors];
        for (std::size_t v = 0; v < kVectors; ++v) w[v] = hn::LoadU(d16, weights + 2 * v * kLanes);
        for (std::size_t p = 0; p < kPixels; ++p) {
          std::int32_t both = 0;
          std::memcpy(&both, source + p * c.stride * pixel, sizeof(both));
          const auto levels = hn::BitCast(d16, hn::Set(d32, both));
          for (std::size_t v = 0; v < kVectors; ++v) sums[p][v].add(w[v], levels);
        }
      }
    }
  const DFloat d;
  const D16Half half;
  for (std::size_t v = 0; v < kVectors; ++v) {
    const auto scale = hn::LoadU(d, c.scale + first + v * kLanes), offset = hn::LoadU(d, c.offset + first + v * kLanes);
    for (std::size_t p = 0; p < kPixels; ++p) {
      const auto sum = hn::ConvertTo(d, sums[p][v].total());
      const auto level = hn::Min(hn::Max(hn::Add(hn::Mul(sum, scale), offset), hn::Zero(d)), hn::Set(d, kMostActive));
      hn::StoreU(hn::DemoteTo(half, hn::NearestInt(level)), half, output + p * c.outputs + first + v * kLanes);
    }
  }
}

template <std::size_t kPixels, class Sums>
HWY_INLINE void pixels(const Convolution& c, const std::int16_t* input, std::size_t input_row, std::int16_t* output) {
  std::size_t first = 0;
  if constexpr (kHasManyRegisters) {
    if constexpr (kPixels <= 3)
      for (; first + 4 * kLanes <= c.outputs; first += 4 * kLanes)
        block<kPixels, 4, Sums>(c, input, input_row, first, output);
    if (first + 3 * kLanes == c.outputs) {
      block<kPixels, 3, Sums>(c, input, input_row, first, output);
      return;
    }
  }
  for (; first + 2 * kLanes <= c.outputs; first += 2 * kLanes)
    block<kPixels, 2, Sums>(c, input, input_row, first, output);
  for (; first < c.outputs; first += kLanes) block<kPixels, 1, Sums>(c, input, input_row, first, output);
}

template <class Sums>
HWY_INLINE void convolve_by(const Convolution& c, const std::int16_t* input, std::size_t input_row,
                            std::int16_t* output, std::size_t output_row) {
  const std::size_t pixel = 2 * c.pairs * c.stride;
  for (std::size_t v = 0; v < c.height; ++v) {
    const std::int16_t* source = input + v * c.stride * input_row;
    std::int16_t* target = output + v * output_row;
    std::size_t u = 0;
    for (; u + 6 <= c.width; u += 6) pixels<6, Sums>(c, source + u * pixel, input_row, target + u * c.outputs);
    for (; u + 3 <= c.width; u += 3) pixels<3, Sums>(c, source + u * pixel, input_row, target + u * c.outputs);
    for (; u < c.width; ++u) pixels<1, Sums>(c, source + u * pixel, input_row, target + u * c.outputs);
  }
}

#endif

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_TARGET == HWY_AVX3
HWY_PUSH_ATTRIBUTES(FLIES_BYTE_PRODUCTS)
namespace flies::kernels::HWY_NAMESPACE {

/// `PairSums` by one instruction, in the compiler's own type of vector: it would copy each sum to and fro otherwise.
class PairSumsAtOnce {
 public:
  inline PairSumsAtOnce() : sums_{} {}
  inline void add(hn::Vec<D16> a, hn::Vec<D16> b) {
    sums_ = reinterpret_cast<Lanes>(_mm512_dpwssd_epi32(reinterpret_cast<__m512i>(sums_), a.raw, b.raw));
  }
  inline hn::Vec<D32> total() const { return hn::Vec<D32>{reinterpret_cast<__m512i>(sums_)}; }

 private:
  using Lanes = std::int32_t __attribute__((vector_size(64)));
  Lanes sums_;
};

void convolve_at_once(const Convolution& c, const std::int16_t* input, std::size_t input_row, std::int16_t* output,
                      std::size_t output_row) {
  convolve_by<PairSumsAtOnce>(c, input, input_row, output, output_row);
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_POP_ATTRIBUTES
#endif

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

void Convolve(const Convolution& c, const std::int16_t* input, std::size_t input_row, std::int16_t* output,
              std::size_t output_row) {
#if HWY_TARGET == HWY_AVX3
  static const bool at_once = chosen_kernel().target == "AVX3_DL";
  if (at_once) return convolve_at_once(c, input, input_row, output, output_row);
#endif
  convolve_by<PairSums>(c, input, input_row, output, output_row);
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(Convolve);

void convolve(const Convolution& convolution, const std::int16_t* input, std::size_t input_row, std::int16_t* output,
              std::size_t output_row) {
  assert(convolution.outputs % kConvolutionLanes == 0);
  HWY_DYNAMIC_DISPATCH(Convolve)(convolution, input, input_row, output, output_row);
}

}  // namespace flies::kernels
#endif
