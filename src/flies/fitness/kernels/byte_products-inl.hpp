// Sums of products of bytes, where the CPU has them (VNNI) and shifts pairs of lanes (VBMI2): no include guard. What
// uses it stands between HWY_PUSH_ATTRIBUTES(FLIES_BYTE_PRODUCTS) and HWY_POP_ATTRIBUTES, and runs where
// `chosen_kernel` is AVX3_DL. It is no target of Highway's: for that, version 1.0 enables AVX-VNNI, which CPUs with
// AVX-512 need not have.

#undef FLIES_BYTE_PRODUCTS
#define FLIES_BYTE_PRODUCTS HWY_TARGET_STR ",avx512vnni,avx512vbmi2"
#undef FLIES_BYTE_PRODUCTS_ATTR  // as HWY_ATTR, for lambdas
#define FLIES_BYTE_PRODUCTS_ATTR __attribute__((target(FLIES_BYTE_PRODUCTS)))

#if HWY_TARGET == HWY_AVX3
HWY_PUSH_ATTRIBUTES(FLIES_BYTE_PRODUCTS)
namespace flies::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using DW8 = hn::FixedTag<std::uint8_t, 64>;
using DW32 = hn::FixedTag<std::int32_t, 16>;
using DW64 = hn::FixedTag<std::int64_t, 8>;
using DWF = hn::FixedTag<float, 16>;
using W32 = hn::Vec<DW32>;
using W64 = hn::Vec<DW64>;
using WF = hn::Vec<DWF>;

constexpr int kQuadRows = 4;
constexpr int kGroups = 4;  ///< of four columns

/// Sums of four products of bytes in each lane, of those without by those with a sign.
HWY_INLINE W32 add_byte_products(W32 sums, W32 without_sign, W32 with_sign) {
  return W32{_mm512_dpbusd_epi32(sums.raw, without_sign.raw, with_sign.raw)};
}

/// Four rows of four images or places, a block of 16 bytes for each. Transposed: lane j of block b belongs to row j of
/// place b, its bytes in group g are columns 4 g to 4 g + 3.
struct Quad {
  W32 group[kGroups];

  Quad() = default;
  HWY_INLINE explicit Quad(const W32 (&rows)[kQuadRows]) {
    const DW32 d;
    const DW64 d64;
    const auto lower = [&](W32 a, W32 b) HWY_ATTR { return hn::BitCast(d64, hn::InterleaveLower(d, a, b)); };
    const auto upper = [&](W32 a, W32 b) HWY_ATTR { return hn::BitCast(d64, hn::InterleaveUpper(d, a, b)); };
    const W64 lower01 = lower(rows[0], rows[1]), lower23 = lower(rows[2], rows[3]);
    const W64 upper01 = upper(rows[0], rows[1]), upper23 = upper(rows[2], rows[3]);
    group[0] = hn::BitCast(d, hn::InterleaveLower(d64, lower01, lower23));
    group[1] = hn::BitCast(d, hn::InterleaveUpper(d64, lower01, lower23));
    group[2] = hn::BitCast(d, hn::InterleaveLower(d64, upper01, upper23));
    group[3] = hn::BitCast(d, hn::InterleaveUpper(d64, upper01, upper23));
  }
  /// The columns to the right of these.
  HWY_INLINE Quad next_columns() const {
    Quad next;
    for (int g = 0; g + 1 < kGroups; ++g) next.group[g] = W32{_mm512_shrdi_epi32(group[g].raw, group[g + 1].raw, 8)};
    next.group[kGroups - 1] = W32{_mm512_srli_epi32(group[kGroups - 1].raw, 8)};
    return next;
  }
};

/// Four blocks.
HWY_INLINE W32 load_blocks(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c, const std::uint8_t* d) {
  const auto block = [](const std::uint8_t* at)
                         HWY_ATTR { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at)); };
  const __m256i ab = _mm256_inserti128_si256(_mm256_castsi128_si256(block(a)), block(b), 1);
  const __m256i cd = _mm256_inserti128_si256(_mm256_castsi128_si256(block(c)), block(d), 1);
  return W32{_mm512_inserti64x4(_mm512_castsi256_si512(ab), cd, 1)};
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_POP_ATTRIBUTES
#endif  // HWY_TARGET == HWY_AVX3
