// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation. It is
// compiled without contraction of products and sums, which would round differently where the CPU can fuse them.
#include "flies/evolve/kernels/scouts.hpp"

#include <algorithm>
#include <limits>

#include "flies/core/random.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/evolve/kernels/scouts.cpp"
// Vectors without a compile-time size: a row is too narrow to gain from them, NEON serves it as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using D32 = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
constexpr std::size_t kLanes = hn::MaxLanes(D());

/// Flies at a time.
constexpr std::size_t kBlock = 64;
constexpr int kReach_px = kRowColumns / 2;

template <std::size_t kTerms>
HWY_INLINE V polynomial(const float (&coefficients)[kTerms], V x) {
  V value = hn::Set(D(), coefficients[kTerms - 1]);
  for (std::size_t i = kTerms - 1; i-- > 0;) value = hn::Add(hn::Mul(value, x), hn::Set(D(), coefficients[i]));
  return value;
}

/// Logarithm to base 2 of positive numbers, to 2e-5.
HWY_INLINE V log2(V x) {
  constexpr float kPolynomial[] = {-2.79415369F, 5.06975651F, -3.52021885F, 1.61017752F, -0.409475595F, 0.0439286269F};
  const D32 d32;
  const auto bits = hn::BitCast(d32, x);
  const auto exponent = hn::Sub(hn::ShiftRight<23>(bits), hn::Set(d32, 127));
  const auto mantissa = hn::Or(hn::And(bits, hn::Set(d32, 0x7fffff)), hn::Set(d32, 127 << 23));
  return hn::Add(hn::ConvertTo(D(), exponent), polynomial(kPolynomial, hn::BitCast(D(), mantissa)));
}

/// 2 to the power of x, to 4e-6 of it, where that is a normal number.
HWY_INLINE V exp2(V x) {
  constexpr float kPolynomial[] = {1.00000358F, 0.692969561F, 0.241621315F, 0.0517177358F, 0.0136839831F};
  const D32 d32;
  const V whole = hn::Floor(x);
  const auto scale = hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(d32, whole), hn::Set(d32, 127)));
  return hn::Mul(polynomial(kPolynomial, hn::Sub(x, whole)), hn::BitCast(D(), scale));
}

HWY_INLINE V linear(const Linear& f, V u, V v) {
  const D d;
  return hn::Add(hn::Set(d, f.constant), hn::Add(hn::Mul(hn::Set(d, f.per_u), u), hn::Mul(hn::Set(d, f.per_v), v)));
}

/// Where the flies of a block look, and how far along.
struct Sights {
  HWY_ALIGN float u_px[kBlock], v_px[kBlock];
  HWY_ALIGN float least_q[kBlock], most_q[kBlock], log_least[kBlock], log_step[kBlock];
  HWY_ALIGN std::int32_t column[kBlock],
      row[kBlock];  ///< of the first pixel of the row; -1 when there is nothing to try
};

HWY_INLINE void look(const ScoutSearch& search, Sights& sights, std::size_t k) {
  const D d;
  const D32 d32;
  const V u = hn::Load(d, sights.u_px + k), v = hn::Load(d, sights.v_px + k);
  V least = linear(search.farthest.bounds[0], u, v), most = linear(search.nearest.bounds[0], u, v);
  for (std::size_t i = 1; i < search.farthest.count; ++i)
    least = hn::Max(least, linear(search.farthest.bounds[i], u, v));
  for (std::size_t i = 1; i < search.nearest.count; ++i) most = hn::Min(most, linear(search.nearest.bounds[i], u, v));
  const auto set = [&](int value) HWY_ATTR { return hn::Set(d, static_cast<float>(value)); };
  // The pixels behind a row that are read with it belong to the row below, so there must be one.
  const V half = hn::Set(d, 0.5F);
  const auto in_image =
      hn::And(hn::And(hn::Ge(u, hn::Sub(set(kReach_px), half)),
                      hn::Lt(u, hn::Sub(set(search.left.width_px - kReach_px), half))),
              hn::And(hn::Ge(v, hn::Zero(d)), hn::Lt(v, hn::Sub(set(search.left.height_px - 1), half))));
  const auto tried = hn::And(in_image, hn::And(hn::Gt(least, hn::Zero(d)), hn::Lt(least, most)));
  const V log_least = log2(hn::IfThenElse(tried, least, set(1)));
  const V log_most = log2(hn::IfThenElse(tried, most, set(2)));
  hn::Store(least, d, sights.least_q + k);
  hn::Store(most, d, sights.most_q + k);
  hn::Store(log_least, d, sights.log_least + k);
  hn::Store(hn::Div(hn::Sub(log_most, log_least), set(search.scouts)), d, sights.log_step + k);
  const auto pixel = [&](V coordinate)
                         HWY_ATTR { return hn::ConvertTo(d32, hn::IfThenElseZero(tried, hn::Add(coordinate, half))); };
  const auto column = hn::Sub(pixel(u), hn::Set(d32, kReach_px));
  hn::Store(hn::IfThenElse(hn::RebindMask(d32, tried), column, hn::Set(d32, -1)), d32, sights.column + k);
  hn::Store(pixel(v), d32, sights.row + k);
}

/// What is tried for one fly. Places of the right image that rows start at; those that leave it are not `seen`.
struct Trials {
  static constexpr std::size_t kCapacity = static_cast<std::size_t>(kMaxScouts) + 16;
  HWY_ALIGN float disparity_px[kCapacity], likeness[kCapacity];
  HWY_ALIGN std::int32_t column[kCapacity];
  HWY_ALIGN std::int32_t covariance[kCapacity], sum[kCapacity], squares[kCapacity];  ///< the first times n
};

HWY_INLINE void choose(const ScoutSearch& search, const Sights& sights, std::size_t fly, float jitter, Trials& trials) {
  const D d;
  const D32 d32;
  const V log_least = hn::Set(d, sights.log_least[fly]), log_step = hn::Set(d, sights.log_step[fly]);
  const V last_column = hn::Set(d, static_cast<float>(search.right.width_px - kRowColumns));
  for (std::size_t k = 0; k < static_cast<std::size_t>(search.scouts); k += kLanes) {
    const V step = hn::Add(hn::Iota(d, static_cast<float>(k)), hn::Set(d, jitter));
    const V q = exp2(hn::Add(log_least, hn::Mul(step, log_step)));
    const V bounded = hn::Min(hn::Max(q, hn::Set(d, sights.least_q[fly])), hn::Set(d, sights.most_q[fly]));
    const V disparity = hn::Add(bounded, hn::Set(d, search.infinity_px));
    const V first =
        hn::Sub(hn::Sub(hn::Set(d, sights.u_px[fly]), disparity), hn::Set(d, static_cast<float>(kReach_px)));
    const auto seen = hn::And(hn::Ge(first, hn::Zero(d)), hn::Lt(first, hn::Add(last_column, hn::Set(d, 0.5F))));
    const V safe = hn::IfThenElse(seen, hn::Add(first, hn::Set(d, 0.5F)), hn::Set(d, -1.0F));
    hn::Store(disparity, d, trials.disparity_px + k);
    hn::Store(hn::ConvertTo(d32, safe), d32, trials.column + k);
  }
}

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE void sum_rows(const std::uint8_t* left, const std::uint8_t* right, std::size_t count, Trials& trials) {
  int left_sum = 0;
  for (int i = 0; i < kRowColumns; ++i) left_sum += left[i];
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t* row = right + std::max(trials.column[k], 0);
    trials.covariance[k] = trials.sum[k] = trials.squares[k] = 0;
    for (int i = 0; i < kRowColumns; ++i) {
      trials.covariance[k] += (kRowColumns * left[i] - left_sum) * row[i];
      trials.sum[k] += row[i];
      trials.squares[k] += row[i] * row[i];
    }
  }
}

#else

using D8 = hn::FixedTag<std::uint8_t, 16>;
using D16 = hn::FixedTag<std::int16_t, 8>;
using D4x32 = hn::FixedTag<std::int32_t, 4>;
using V4x32 = hn::Vec<D4x32>;

/// The two halves of 16 columns.
struct Row {
  hn::Vec<D16> first, last;
};

HWY_INLINE Row load(const std::uint8_t* row, hn::Vec<D8> inside) {
  const auto pixels = hn::And(hn::LoadU(D8(), row), inside);
  const hn::Half<D8> half;
  return {hn::PromoteTo(D16(), hn::LowerHalf(half, pixels)), hn::PromoteTo(D16(), hn::UpperHalf(half, pixels))};
}

HWY_INLINE V4x32 pair_products(hn::Vec<D16> a, hn::Vec<D16> b) {
  const D4x32 d;
  V4x32 high = hn::Zero(d);
  const V4x32 low = hn::ReorderWidenMulAccumulate(d, a, b, hn::Zero(d), high);
  return hn::Add(low, high);
}

HWY_INLINE V4x32 sum_of_products(const Row& a, const Row& b) {
  return hn::Add(pair_products(a.first, b.first), pair_products(a.last, b.last));
}

/// The sums of the lanes of four vectors.
HWY_INLINE V4x32 fold(const V4x32 (&v)[4]) {
  const D4x32 d;
  const auto pairs = [&](V4x32 a, V4x32 b)
                         HWY_ATTR { return hn::Add(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b)); };
  const V4x32 low = pairs(v[0], v[1]), high = pairs(v[2], v[3]);
  return hn::Add(hn::ConcatLowerLower(d, high, low), hn::ConcatUpperUpper(d, high, low));
}

/// Exact: none of the sums exceeds 25 bits.
HWY_INLINE void sum_rows(const std::uint8_t* left, const std::uint8_t* right, std::size_t count, Trials& trials) {
  const D4x32 d;
  const D16 d16;
  const auto inside = hn::VecFromMask(D8(), hn::FirstN(D8(), kRowColumns));
  const auto one = hn::Set(d16, 1);
  const Row l = load(left, inside);
  const V4x32 left_pairs = pair_products(hn::Add(l.first, l.last), one);
  const auto left_sum = hn::Set(d16, static_cast<std::int16_t>(hn::GetLane(hn::SumOfLanes(d, left_pairs))));
  // Columns behind the row are 0 on the right.
  const auto centre = [&](hn::Vec<D16> pixels)
                          HWY_ATTR { return hn::Sub(hn::Mul(pixels, hn::Set(d16, kRowColumns)), left_sum); };
  const Row centred = {centre(l.first), centre(l.last)};
  for (std::size_t k = 0; k < count; k += 4) {
    V4x32 covariance[4], sum[4], squares[4];
    for (std::size_t i = 0; i < 4; ++i) {
      const Row r = load(right + std::max(trials.column[k + i], 0), inside);
      covariance[i] = sum_of_products(centred, r);
      sum[i] = pair_products(hn::Add(r.first, r.last), one);
      squares[i] = sum_of_products(r, r);
    }
    hn::Store(fold(covariance), d, trials.covariance + k);
    hn::Store(fold(sum), d, trials.sum + k);
    hn::Store(fold(squares), d, trials.squares + k);
  }
}

#endif

/// Covariance of the rows over the right one's standard deviation, squared but for its sign: orders rows that are held
/// against the same left one as the correlation coefficient does.
HWY_INLINE std::size_t most_alike(const ScoutSearch& search, std::size_t count, Trials& trials) {
  const D d;
  const D32 d32;
  for (std::size_t k = 0; k < count; k += kLanes) {
    const auto sum = hn::Load(d32, trials.sum + k);
    const auto variance =
        hn::Sub(hn::Mul(hn::Load(d32, trials.squares + k), hn::Set(d32, kRowColumns)), hn::Mul(sum, sum));
    const V covariance = hn::ConvertTo(d, hn::Load(d32, trials.covariance + k));
    const V likeness = hn::Div(hn::Mul(covariance, hn::Abs(covariance)),
                               hn::Add(hn::ConvertTo(d, variance), hn::Set(d, search.noise)));
    const auto seen = hn::RebindMask(d, hn::Gt(hn::Load(d32, trials.column + k), hn::Set(d32, -1)));
    const V none = hn::Set(d, -std::numeric_limits<float>::infinity());
    hn::Store(hn::IfThenElse(seen, likeness, none), d, trials.likeness + k);
  }
  std::size_t best = 0;
  for (std::size_t k = 1; k < count; ++k) best = trials.likeness[k] > trials.likeness[best] ? k : best;
  return best;
}

void ScoutFlies(const ScoutSearch& search, std::uint32_t first_fly, std::size_t count, const float* u_px,
                const float* v_px, float* disparity_px) {
  Sights sights = {};
  Trials trials = {};
  const auto scouts = static_cast<std::size_t>(search.scouts);
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t flies = std::min(kBlock, count - begin);
    std::copy_n(u_px + begin, flies, sights.u_px);
    std::copy_n(v_px + begin, flies, sights.v_px);
    for (std::size_t k = 0; k < flies; k += kLanes) look(search, sights, k);
    for (std::size_t k = 0; k < flies; ++k) {
      if (sights.column[k] < 0) continue;
      const auto fly = first_fly + static_cast<std::uint32_t>(begin + k);
      const auto words = fly_words(search.seed, search.purpose, search.generation, fly, 0);
      choose(search, sights, k, static_cast<float>(words[0] >> 8) * 0x1p-24F, trials);
      sum_rows(search.left.row(sights.row[k]) + sights.column[k], search.right.row(sights.row[k]), scouts, trials);
      const std::size_t best = most_alike(search, scouts, trials);
      if (trials.column[best] >= 0) disparity_px[begin + k] = trials.disparity_px[best];
    }
  }
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(ScoutFlies);

void scout_flies(const ScoutSearch& search, std::uint32_t first_fly, std::size_t count, const float* u_px,
                 const float* v_px, float* disparity_px) {
  HWY_DYNAMIC_DISPATCH(ScoutFlies)(search, first_fly, count, u_px, v_px, disparity_px);
}

}  // namespace flies::kernels
#endif
