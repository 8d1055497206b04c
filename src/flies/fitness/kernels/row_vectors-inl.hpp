// The vectors that vector_kernel.cpp computes with, once for each instruction set: no include guard.
// A vector has 32 bytes where the instruction set has them and 16 otherwise; "block" means 16 bytes.

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

using D8 = hn::CappedTag<std::uint8_t, 32>;
using D16 = hn::Repartition<std::int16_t, D8>;
using D32 = hn::Repartition<std::int32_t, D8>;
using D64 = hn::Repartition<std::int64_t, D8>;
using DU32 = hn::RebindToUnsigned<D32>;
using DU64 = hn::RebindToUnsigned<D64>;
using DF = hn::Repartition<float, D8>;
using V8 = hn::Vec<D8>;
using V16 = hn::Vec<D16>;
using V32 = hn::Vec<D32>;
using V64 = hn::Vec<D64>;
using VU32 = hn::Vec<DU32>;
using VU64 = hn::Vec<DU64>;
using VF = hn::Vec<DF>;

constexpr int kBlocks = static_cast<int>(hn::MaxLanes(D8())) / 16;  ///< 1 or 2
constexpr int kParts = 2 / kBlocks;  ///< vectors that 16 columns of 16 bits take, and 8 rows of 32 bits

/// Columns of a patch that are read from one block: the interpolation needs one more.
constexpr int kChunkColumns = 15;

HWY_INLINE V8 load_twice(const std::uint8_t* block) {
#if HWY_MAX_BYTES >= 32
  return hn::LoadDup128(D8(), block);
#else
  return hn::LoadU(D8(), block);
#endif
}

/// Bytes times weights of 0 to 16, neighbouring products added.
HWY_INLINE V16 weigh_pairs(V8 bytes, V8 weights) {
#if HWY_ARCH_X86 && HWY_MAX_BYTES >= 32
  return V16{_mm256_maddubs_epi16(bytes.raw, weights.raw)};
#elif HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128
  return V16{_mm_maddubs_epi16(bytes.raw, weights.raw)};
#else
  const D16 d;
  const V16 low = hn::Set(d, 0xFF);
  const auto even = [&](V8 v) HWY_ATTR { return hn::And(hn::BitCast(d, v), low); };
  const auto odd = [&](V8 v) HWY_ATTR {
    return hn::BitCast(d, hn::ShiftRight<8>(hn::BitCast(hn::RebindToUnsigned<D16>(), v)));
  };
  return hn::Add(hn::Mul(even(bytes), even(weights)), hn::Mul(odd(bytes), odd(weights)));
#endif
}

/// Two accumulators, as instruction sets add the products of neighbouring columns to one or to both.
struct Sum {
  V32 a, b;

  HWY_INLINE Sum() : a(hn::Zero(D32())), b(hn::Zero(D32())) {}
  HWY_INLINE void add_products(V16 x, V16 y) { a = hn::ReorderWidenMulAccumulate(D32(), x, y, a, b); }
  HWY_INLINE V32 total() const { return hn::Add(a, b); }
};

/// x0 + x4, y0 + y4, x1 + x5, y1 + y5, ... of the T lanes of each block.
template <class T>
HWY_INLINE V16 fold(V16 x, V16 y) {
  const hn::Repartition<T, D16> d;
  const auto x_t = hn::BitCast(d, x), y_t = hn::BitCast(d, y);
  return hn::Add(hn::BitCast(D16(), hn::InterleaveLower(d, x_t, y_t)),
                 hn::BitCast(D16(), hn::InterleaveUpper(d, x_t, y_t)));
}

/// The same for vectors of 32-bit and of 64-bit sums.
template <class T>
HWY_INLINE V32 fold(V32 x, V32 y) {
  const hn::Repartition<T, D32> d;
  const auto x_t = hn::BitCast(d, x), y_t = hn::BitCast(d, y);
  return hn::Add(hn::BitCast(D32(), hn::InterleaveLower(d, x_t, y_t)),
                 hn::BitCast(D32(), hn::InterleaveUpper(d, x_t, y_t)));
}
template <class T>
HWY_INLINE V64 fold(V64 x, V64 y) {
  const hn::Repartition<T, D64> d;
  return hn::Add(hn::InterleaveLower(d, x, y), hn::InterleaveUpper(d, x, y));
}

#endif  // HWY_TARGET != HWY_SCALAR
}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
