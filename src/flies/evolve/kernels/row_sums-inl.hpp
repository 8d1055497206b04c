// What scouts compare rows by, sums over the columns of both, on integers: no include guard, included once for each
// instruction set.
#include "flies/evolve/kernels/scouts.hpp"
// After what every instruction set has.
#include "flies/fitness/kernels/byte_products-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// What is tried for one fly.
struct Trials {
  static constexpr std::size_t kCapacity = static_cast<std::size_t>(kMaxScouts) + 16;
  HWY_ALIGN float disparity_px[kCapacity];
  HWY_ALIGN float unseen[kCapacity];         ///< minus infinity where the row would leave the right image, else 0
  HWY_ALIGN std::int32_t column[kCapacity];  ///< of the right image that the row starts at; 0 where it would leave it
  HWY_ALIGN std::int32_t covariance[kCapacity], sum[kCapacity], squares[kCapacity];  ///< the first times n
};

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE void sum_rows(const std::uint8_t* left, const std::uint8_t* right, std::size_t count, Trials& trials) {
  int left_sum = 0;
  for (int i = 0; i < kRowColumns; ++i) left_sum += left[i];
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t* row = right + trials.column[k];
    trials.covariance[k] = trials.sum[k] = trials.squares[k] = 0;
    for (int i = 0; i < kRowColumns; ++i) {
      trials.covariance[k] += (kRowColumns * left[i] - left_sum) * row[i];
      trials.sum[k] += row[i];
      trials.squares[k] += row[i] * row[i];
    }
  }
}

#else

using D16 = hn::CappedTag<std::int16_t, 16>;
using D8 = hn::Rebind<std::uint8_t, D16>;
using DSums = hn::RepartitionToWide<D16>;
using V16 = hn::Vec<D16>;
using VSums = hn::Vec<DSums>;

/// 16 columns of a row in one vector or two.
constexpr std::size_t kColumnLanes = hn::MaxLanes(D16());
constexpr std::size_t kParts = 16 / kColumnLanes;
struct Row {
  HWY_INLINE Row() {}  // a constructor of the compiler's own would not be compiled for the instruction set
  V16 part[kParts];
};

/// The columns of a row, and 0 behind them.
HWY_INLINE Row load(const std::uint8_t* row) {
  alignas(16) static constexpr std::uint8_t kInside[16] = {255, 255, 255, 255, 255, 255, 255,
                                                           255, 255, 255, 255, 255, 255};
  Row loaded;
  for (std::size_t i = 0; i < kParts; ++i) {
    const auto pixels = hn::And(hn::LoadU(D8(), row + i * kColumnLanes), hn::Load(D8(), kInside + i * kColumnLanes));
    loaded.part[i] = hn::PromoteTo(D16(), pixels);
  }
  return loaded;
}

HWY_INLINE VSums pair_products(V16 a, V16 b) {
  const DSums d;
  VSums high = hn::Zero(d);
  const VSums low = hn::ReorderWidenMulAccumulate(d, a, b, hn::Zero(d), high);
  return hn::Add(low, high);
}

HWY_INLINE VSums sum_of_products(const Row& a, const Row& b) {
  VSums sum = pair_products(a.part[0], b.part[0]);
  if constexpr (kParts == 2) sum = hn::Add(sum, pair_products(a.part[kParts - 1], b.part[kParts - 1]));
  return sum;
}

HWY_INLINE VSums sum_of(const Row& a) {
  const V16 pixels = kParts == 2 ? hn::Add(a.part[0], a.part[kParts - 1]) : a.part[0];
  return pair_products(pixels, hn::Set(D16(), 1));
}

/// The sums of the lanes of each of four vectors.
HWY_INLINE void store_sums(const VSums (&v)[4], std::int32_t* sums) {
  const DSums d;
  const hn::RepartitionToWide<DSums> d64;
  const auto pairs = [&](VSums a, VSums b) HWY_ATTR {
    return hn::BitCast(d64, hn::Add(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b)));
  };
  const auto low = pairs(v[0], v[1]), high = pairs(v[2], v[3]);
  const VSums all =
      hn::Add(hn::BitCast(d, hn::InterleaveLower(d64, low, high)), hn::BitCast(d, hn::InterleaveUpper(d64, low, high)));
  const hn::FixedTag<std::int32_t, 4> d4;
#if HWY_MAX_BYTES >= 32
  hn::Store(hn::Add(hn::LowerHalf(d4, all), hn::UpperHalf(d4, all)), d4, sums);
#else
  hn::Store(all, d4, sums);
#endif
}

/// Exact: none of the sums exceeds 25 bits.
HWY_INLINE void sum_rows(const std::uint8_t* left, const std::uint8_t* right, std::size_t count, Trials& trials) {
  const D16 d16;
  const Row l = load(left);
  const auto left_sum = hn::Set(d16, static_cast<std::int16_t>(hn::GetLane(hn::SumOfLanes(DSums(), sum_of(l)))));
  Row centred;  // but for the columns behind the row, which are 0 on the right
  for (std::size_t i = 0; i < kParts; ++i)
    centred.part[i] = hn::Sub(hn::Mul(l.part[i], hn::Set(d16, kRowColumns)), left_sum);
  for (std::size_t k = 0; k < count; k += 4) {
    VSums covariance[4], sum[4], squares[4];
    for (std::size_t i = 0; i < 4; ++i) {
      const Row r = load(right + trials.column[k + i]);
      covariance[i] = sum_of_products(centred, r);
      sum[i] = sum_of(r);
      squares[i] = sum_of_products(r, r);
    }
    store_sums(covariance, trials.covariance + k);
    store_sums(sum, trials.sum + k);
    store_sums(squares, trials.squares + k);
  }
}

#endif

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_TARGET == HWY_AVX3
HWY_PUSH_ATTRIBUTES(FLIES_BYTE_PRODUCTS)
namespace flies::kernels::HWY_NAMESPACE {

/// The four groups of columns of a block, each in all lanes.
struct BlockGroups {
  W32 group[kGroups];
  HWY_INLINE explicit BlockGroups(W32 block)
      : group{hn::Broadcast<0>(block), hn::Broadcast<1>(block), hn::Broadcast<2>(block), hn::Broadcast<3>(block)} {}
};

/// `sum_rows` of 16 rows at once.
HWY_INLINE void sum_rows_by_bytes(const std::uint8_t* left, const std::uint8_t* right, std::size_t count,
                                  Trials& trials) {
  const DW32 d;
  const auto all_blocks = [&](const std::uint8_t* block)
                              HWY_ATTR { return hn::BitCast(d, hn::LoadDup128(DW8(), block)); };
  alignas(16) static constexpr std::uint8_t kInside[16] = {255, 255, 255, 255, 255, 255, 255,
                                                           255, 255, 255, 255, 255, 255};
  const W32 inside_block = all_blocks(kInside), one = hn::Set(d, 0x01010101);
  const W32 middle = hn::Set(d, static_cast<std::int32_t>(0x80808080));
  const BlockGroups inside(inside_block), ones(hn::And(inside_block, one));
  // Grey levels less 128, which changes neither covariance nor variance.
  const BlockGroups l(hn::And(hn::Xor(all_blocks(left), middle), inside_block));
  W32 l_sum = hn::Zero(d);
  for (int g = 0; g < kGroups; ++g) l_sum = add_byte_products(l_sum, one, l.group[g]);
  for (std::size_t k = 0; k < count; k += 16) {
    W32 rows[kQuadRows];
    for (std::size_t j = 0; j < kQuadRows; ++j) {
      const auto row = [&](std::size_t block) { return right + trials.column[k + 4 * block + j]; };
      rows[j] = load_blocks(row(0), row(1), row(2), row(3));
    }
    const Quad r(rows);
    W32 products = hn::Zero(d), sum = hn::Zero(d), squares = hn::Zero(d);
    for (int g = 0; g < kGroups; ++g) {
      const W32 r_signed = hn::And(hn::Xor(r.group[g], middle), inside.group[g]);
      products = add_byte_products(products, r.group[g], l.group[g]);
      sum = add_byte_products(sum, r.group[g], ones.group[g]);
      squares = add_byte_products(squares, r.group[g], r_signed);
    }
    const W32 n = hn::Set(d, kRowColumns);
    hn::Store(hn::Sub(hn::Mul(products, n), hn::Mul(sum, l_sum)), d, trials.covariance + k);
    hn::Store(sum, d, trials.sum + k);
    hn::Store(hn::Add(squares, hn::ShiftLeft<7>(sum)), d, trials.squares + k);
  }
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_POP_ATTRIBUTES
#endif
