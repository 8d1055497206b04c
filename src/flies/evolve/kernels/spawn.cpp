// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation. It is
// compiled without contraction of products and sums, which would round differently where the CPU can fuse them.
#include "flies/evolve/kernels/spawn.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flies/core/random.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/evolve/kernels/spawn.cpp"
// Vectors without a compile-time size: the last vectors of a block could reach beyond it.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using D32 = hn::RebindToSigned<D>;
using DU32 = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;

/// Flies at a time, and the same with room for a last vector.
constexpr std::size_t kBlock = 256;
constexpr std::size_t kPadded = kBlock + 16;

/// Largest difference of grey levels of the 13 columns from `window` on.
HWY_INLINE int contrast(const std::uint8_t* window) {
#if HWY_TARGET == HWY_SCALAR
  const auto [darkest, brightest] = std::minmax_element(window, window + kMinWidth_px);
  return *brightest - *darkest;
#else
  // Two overlapping halves; then the maxima of the grey levels and of their complements side by side.
  const hn::FixedTag<std::uint8_t, 8> half;
  const hn::FixedTag<std::uint8_t, 16> full;
  const hn::Repartition<std::uint64_t, decltype(full)> halves;
  const auto a = hn::LoadU(half, window), b = hn::LoadU(half, window + kMinWidth_px - 8);
  auto largest = hn::Combine(full, hn::Not(hn::Min(a, b)), hn::Max(a, b));
  largest = hn::Max(largest, hn::BitCast(full, hn::ShiftRight<32>(hn::BitCast(halves, largest))));
  largest = hn::Max(largest, hn::BitCast(full, hn::ShiftRight<16>(hn::BitCast(halves, largest))));
  largest = hn::Max(largest, hn::BitCast(full, hn::ShiftRight<8>(hn::BitCast(halves, largest))));
  const auto brightest = hn::ExtractLane(largest, 0), complement = hn::ExtractLane(largest, 8);
  return static_cast<int>(brightest) + static_cast<int>(complement) - 255;
#endif
}

/// Uniform in [0, 1) from the upper 24 bits of words.
HWY_INLINE V unit(const std::uint32_t* words) {
  const auto upper = hn::ShiftRight<8>(hn::Load(DU32(), words));
  return hn::Mul(hn::ConvertTo(D(), hn::BitCast(D32(), upper)), hn::Set(D(), 0x1p-24F));
}

/// Looks up and interpolates.
HWY_INLINE V at_ratio(const float* table, V ratio) {
  const D d;
  const V place = hn::Mul(ratio, hn::Set(d, static_cast<float>(kRatioSteps)));
  const auto step = hn::ConvertTo(D32(), place);
  HWY_ALIGN std::int32_t steps[hn::MaxLanes(D())];
  HWY_ALIGN float below[hn::MaxLanes(D())], above[hn::MaxLanes(D())];
  hn::Store(step, D32(), steps);
  for (std::size_t i = 0; i < hn::MaxLanes(D()); ++i) {
    below[i] = table[steps[i]];
    above[i] = table[steps[i] + 1];
  }
  const V low = hn::Load(d, below), rest = hn::Sub(place, hn::ConvertTo(d, step));
  return hn::Add(low, hn::Mul(rest, hn::Sub(hn::Load(d, above), low)));
}

HWY_INLINE V linear(const Linear& f, V u, V v) {
  const D d;
  return hn::Add(hn::Set(d, f.constant), hn::Add(hn::Mul(hn::Set(d, f.per_u), u), hn::Mul(hn::Set(d, f.per_v), v)));
}

/// The draws of a block: their words and what they come to.
struct Draws {
  HWY_ALIGN std::uint32_t words[3][kPadded] = {};
  HWY_ALIGN float u_px[kPadded], v_px[kPadded], disparity_px[kPadded];
  HWY_ALIGN std::int32_t column[kPadded], row[kPadded];  ///< nearest pixel; -1 outside the field or the image
};

/// Places the draws from k on, a vector of them.
HWY_INLINE void place(const SpawnSearch& search, Draws& draws, std::size_t k) {
  const D d;
  const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
  const V max_u = set(static_cast<float>(search.left.width_px - 1));
  const V max_v = set(static_cast<float>(search.left.height_px - 1));
  const V u = hn::Mul(unit(draws.words[0] + k), max_u);
  const V height = hn::Add(set(search.min_m), hn::Mul(unit(draws.words[1] + k), set(search.span_m)));
  const V q = search.q_at_ratios == nullptr
                  ? hn::Add(set(search.min_q), hn::Mul(unit(draws.words[2] + k), set(search.span_q)))
                  : at_ratio(search.q_at_ratios, unit(draws.words[2] + k));
  const V v_on_axis = hn::Mul(hn::Add(hn::Mul(height, set(search.v_per_height_q)), set(search.v_per_q)), q);
  const V v = hn::Add(v_on_axis, hn::Add(set(search.v_constant), hn::Mul(set(search.v_per_u), u)));
  const V x = linear(search.x, u, v), y = linear(search.y, u, v);
  const auto between = [](V low, V value, V high) HWY_ATTR { return hn::And(hn::Ge(value, low), hn::Le(value, high)); };
  const auto in_field = hn::And(between(hn::Mul(set(search.x_min_m), q), x, hn::Mul(set(search.x_max_m), q)),
                                between(hn::Mul(set(search.y_min_m), q), y, hn::Mul(set(search.y_max_m), q)));
  const auto held = hn::And(in_field, between(hn::Zero(d), v, max_v));
  const auto pixel = [&](V coordinate) HWY_ATTR {
    const V safe = hn::IfThenElse(held, hn::Add(coordinate, set(0.5F)), set(-1.0F));
    return hn::ConvertTo(D32(), safe);
  };
  hn::Store(u, d, draws.u_px + k);
  hn::Store(v, d, draws.v_px + k);
  hn::Store(hn::Add(q, set(search.infinity_px)), d, draws.disparity_px + k);
  hn::Store(pixel(u), D32(), draws.column + k);
  hn::Store(pixel(v), D32(), draws.row + k);
}

void SpawnFlies(const SpawnSearch& search, std::uint32_t first_fly, std::size_t count, float* u_px, float* v_px,
                float* disparity_px) {
  Draws draws;
  std::array<std::uint32_t, kBlock> pending;
  std::array<bool, kBlock> accepted;
  const int last_window = search.left.width_px - kMinWidth_px;
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    std::size_t left = std::min(kBlock, count - begin);
    for (std::size_t k = 0; k < left; ++k) pending[k] = static_cast<std::uint32_t>(begin + k);
    for (int draw = 0; draw < search.max_draws && left > 0; ++draw) {
      for (std::size_t k = 0; k < left; ++k) {
        const auto words = fly_words(search.seed, search.purpose, search.generation, first_fly + pending[k],
                                     static_cast<std::uint32_t>(draw));
        for (std::size_t w = 0; w < 3; ++w) draws.words[w][k] = words[w];
      }
      for (std::size_t k = 0; k < left; k += hn::MaxLanes(D())) place(search, draws, k);
      // Large images lie in the third level cache: the CPU cannot look far enough ahead by itself.
      for (std::size_t k = 0; k < left; ++k)
        hwy::Prefetch(search.left.row(std::max(draws.row[k], 0)) + std::max(draws.column[k], 0));
      // No branches, which would be mispredicted: every fly takes its last draw, some will draw again.
      for (std::size_t k = 0; k < left; ++k) {
        const auto fly = pending[k];
        u_px[fly] = draws.u_px[k];
        v_px[fly] = draws.v_px[k];
        disparity_px[fly] = draws.disparity_px[k];
        const int window = std::clamp(draws.column[k] - kMinWidth_px / 2, 0, last_window);
        const bool informative = contrast(search.left.row(std::max(draws.row[k], 0)) + window) >= search.min_contrast;
        accepted[k] = informative & (draws.row[k] >= 0);
      }
      std::size_t refused = 0;
      for (std::size_t k = 0; k < left; ++k) {
        pending[refused] = pending[k];
        refused += accepted[k] ? 0 : 1;
      }
      left = refused;
    }
  }
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(SpawnFlies);

void spawn_flies(const SpawnSearch& search, std::uint32_t first_fly, std::size_t count, float* u_px, float* v_px,
                 float* disparity_px) {
  HWY_DYNAMIC_DISPATCH(SpawnFlies)(search, first_fly, count, u_px, v_px, disparity_px);
}

}  // namespace flies::kernels
#endif
