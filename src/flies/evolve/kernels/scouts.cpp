// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation. It is
// compiled without contraction of products and sums, which would round differently where the CPU can fuse them.
#include "flies/evolve/kernels/scouts.hpp"

#include <algorithm>
#include <limits>

#include "flies/core/random.hpp"
#include "flies/fitness/kernels/kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/evolve/kernels/scouts.cpp"
// Vectors without a compile-time size: a row is too narrow to gain from them, NEON serves it as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "flies/evolve/kernels/row_sums-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using D32 = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
constexpr std::size_t kLanes = hn::MaxLanes(D());

/// Flies at a time.
constexpr std::size_t kBlock = 64;

/// Of those, so many take each step together: the steps of one fly wait for each other, those of several do not.
constexpr std::size_t kTogether = 8;
constexpr int kReach_px = kRowColumns / 2;

constexpr float kNone = -std::numeric_limits<float>::infinity();

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
  /// Of the first pixel of the row; the column is -1 where there is nothing to try.
  HWY_ALIGN std::int32_t column[kBlock], row[kBlock];
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
    hn::Store(disparity, d, trials.disparity_px + k);
    hn::Store(hn::IfThenZeroElse(seen, hn::Set(d, kNone)), d, trials.unseen + k);
    hn::Store(hn::ConvertTo(d32, hn::IfThenElseZero(seen, hn::Add(first, hn::Set(d, 0.5F)))), d32, trials.column + k);
  }
}

/// The first of the most alike rows, by their covariance over the right one's standard deviation, squared but for its
/// sign: that orders rows which are held against the same left one as the correlation coefficient does.
HWY_INLINE std::size_t most_alike(const ScoutSearch& search, const Trials& trials) {
  const D d;
  const D32 d32;
  // Not minus infinity: MaxOfLanes of Highway's emulated vectors knows none, so that no lane would equal it.
  V most = hn::Set(d, std::numeric_limits<float>::lowest()), at = hn::Zero(d);
  for (std::size_t k = 0; k < static_cast<std::size_t>(search.scouts); k += kLanes) {
    const auto sum = hn::Load(d32, trials.sum + k);
    const auto variance =
        hn::Sub(hn::Mul(hn::Load(d32, trials.squares + k), hn::Set(d32, kRowColumns)), hn::Mul(sum, sum));
    const V covariance = hn::ConvertTo(d, hn::Load(d32, trials.covariance + k));
    const V likeness = hn::Div(hn::Mul(covariance, hn::Abs(covariance)),
                               hn::Add(hn::ConvertTo(d, variance), hn::Set(d, search.noise)));
    const V number = hn::Iota(d, static_cast<float>(k));
    const V counted = hn::IfThenElse(hn::Lt(number, hn::Set(d, static_cast<float>(search.scouts))),
                                     hn::Add(likeness, hn::Load(d, trials.unseen + k)), hn::Set(d, kNone));
    const auto is_more = hn::Gt(counted, most);
    most = hn::IfThenElse(is_more, counted, most);
    at = hn::IfThenElse(is_more, number, at);
  }
  const V candidates = hn::IfThenElse(hn::Eq(most, hn::MaxOfLanes(d, most)), at, hn::Set(d, float{kMaxScouts}));
  return static_cast<std::size_t>(hn::GetLane(hn::MinOfLanes(d, candidates)));
}

template <class SumRows>
HWY_INLINE void scout_each(const ScoutSearch& search, std::uint32_t first_fly, std::size_t count, const float* u_px,
                           const float* v_px, float* disparity_px, const SumRows& sum_rows) {
  Sights sights = {};
  Trials trials[kTogether] = {};
  std::size_t scouted[kBlock + 1];
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t flies = std::min(kBlock, count - begin);
    std::copy_n(u_px + begin, flies, sights.u_px);
    std::copy_n(v_px + begin, flies, sights.v_px);
    for (std::size_t k = 0; k < flies; k += kLanes) look(search, sights, k);
    std::size_t found = 0;
    for (std::size_t k = 0; k < flies; ++k) {
      scouted[found] = k;
      found += sights.column[k] >= 0 ? 1 : 0;
    }
    for (std::size_t first = 0; first < found; first += kTogether) {
      const std::size_t together = std::min(kTogether, found - first);
      for (std::size_t i = 0; i < together; ++i) {
        const std::size_t k = scouted[first + i];
        const auto fly = first_fly + static_cast<std::uint32_t>(begin + k);
        const auto words = fly_words(search.seed, search.purpose, search.generation, fly, 0);
        choose(search, sights, k, static_cast<float>(words[0] >> 8) * 0x1p-24F, trials[i]);
        // Large images lie in the third level cache. Neighbouring trials often share their pixels' cache line.
        hwy::Prefetch(search.left.row(sights.row[k]) + sights.column[k]);
        for (int trial = 0; trial < search.scouts; trial += 4)
          hwy::Prefetch(search.right.row(sights.row[k]) + trials[i].column[trial]);
      }
      for (std::size_t i = 0; i < together; ++i) {
        const std::size_t k = scouted[first + i];
        sum_rows(search.left.row(sights.row[k]) + sights.column[k], search.right.row(sights.row[k]),
                 static_cast<std::size_t>(search.scouts), trials[i]);
      }
      for (std::size_t i = 0; i < together; ++i) {
        const std::size_t best = most_alike(search, trials[i]);
        float& disparity = disparity_px[begin + scouted[first + i]];
        disparity = trials[i].unseen[best] == 0.0F ? trials[i].disparity_px[best] : disparity;
      }
    }
  }
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_TARGET == HWY_AVX3
HWY_PUSH_ATTRIBUTES(FLIES_BYTE_PRODUCTS)
namespace flies::kernels::HWY_NAMESPACE {

void scout_flies_by_bytes(const ScoutSearch& search, std::uint32_t first_fly, std::size_t count, const float* u_px,
                          const float* v_px, float* disparity_px) {
  scout_each(search, first_fly, count, u_px, v_px, disparity_px,
             [](auto&&... of) FLIES_BYTE_PRODUCTS_ATTR { sum_rows_by_bytes(of...); });
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_POP_ATTRIBUTES
#endif

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

void ScoutFlies(const ScoutSearch& search, std::uint32_t first_fly, std::size_t count, const float* u_px,
                const float* v_px, float* disparity_px) {
#if HWY_TARGET == HWY_AVX3
  static const bool by_bytes = chosen_kernel().target == "AVX3_DL";
  if (by_bytes) return scout_flies_by_bytes(search, first_fly, count, u_px, v_px, disparity_px);
#endif
  scout_each(search, first_fly, count, u_px, v_px, disparity_px, [](auto&&... of) HWY_ATTR { sum_rows(of...); });
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
