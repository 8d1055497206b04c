// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation. It is
// compiled without contraction of products and sums, which would round differently where the CPU can fuse them.
#include "flies/evolve/kernels/rivals.hpp"

#include <initializer_list>
#include <span>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/evolve/kernels/rivals.cpp"
// Vectors without a compile-time size: the looks of four cells are too few to gain from them, NEON serves them as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR

void MarkRivalled(const RivalSearch& search, std::uint8_t* rivalled) { mark_rivalled_scalar(search, rivalled); }

#else

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;  // several looks
using D32 = hn::RebindToSigned<D>;
using DLook = hn::FixedTag<float, 4>;  // one look
constexpr std::size_t kLanes = hn::MaxLanes(D());
constexpr std::size_t kLookLanes = 4;
constexpr std::size_t kColumns = 4;  ///< of cells that are looked at, from the left neighbour on; one more than needed

/// One bit for each lane. Read back by the width in which they are stored, or the CPU would wait for the store.
HWY_INLINE std::uint64_t bits_of(hn::Mask<D> mask) {
  std::conditional_t<kLanes == 16, std::uint16_t, std::uint8_t> bits = 0;
  hn::StoreMaskBits(D(), mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

/// Looks and cells of all flies.
HWY_ATTR void look(const RivalSearch& search) {
  const D d;
  const D32 d32;
  const auto& cells = search.cells;
  std::size_t i = 0;
  for (; i + kLanes <= search.flies; i += kLanes) {
    const auto fitness = hn::LoadU(d, search.fitness + i), v = hn::LoadU(d, search.v_px + i);
    const auto disparity = hn::LoadU(d, search.disparity_px + i);
    const auto u = hn::Sub(hn::LoadU(d, search.u_px + i), hn::Mul(hn::Set(d, search.shift), disparity));
    const auto zero = hn::Zero(d);
    const auto inside = hn::And(hn::And(hn::Gt(fitness, zero), hn::And(hn::Ge(u, zero), hn::Ge(v, zero))),
                                hn::And(hn::Le(u, hn::Set(d, cells.max_u_px)), hn::Le(v, hn::Set(d, cells.max_v_px))));
    // Places outside are taken to 0 first: their coordinates may not fit an integer.
    const auto index = [&](auto place, float per) HWY_ATTR {
      const auto whole = hn::ConvertTo(d32, hn::Mul(hn::IfThenElseZero(inside, place), hn::Set(d, per)));
      return hn::Add(whole, hn::Set(d32, 1));
    };
    const auto cell = hn::Add(hn::Mul(index(v, cells.per_v), hn::Set(d32, cells.columns)), index(u, cells.per_u));
    hn::StoreU(hn::IfThenElseZero(hn::RebindMask(d32, inside), cell), d32,
               reinterpret_cast<std::int32_t*>(search.cell_of_fly + i));
    hn::StoreInterleaved4(fitness, u, v, disparity, d, &search.looks[i].fitness);
  }
  for (; i < search.flies; ++i) {
    const float u_px = search.u_px[i] - search.shift * search.disparity_px[i];
    search.looks[i] = {search.fitness[i], u_px, search.v_px[i], search.disparity_px[i]};
    search.cell_of_fly[i] = search.fitness[i] > 0.0F ? cells.cell(u_px, search.v_px[i]) : 0;
  }
}

/// Lists the flies that `wanted` is true for. Without a branch, which would be mispredicted every other time.
template <class Wanted>
HWY_INLINE std::span<const std::uint32_t> list(const RivalSearch& search, const Wanted& wanted) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < search.flies; ++i) {
    search.listed[count] = static_cast<std::uint32_t>(i);
    count += wanted(i) ? 1 : 0;
  }
  return {search.listed, count};
}

HWY_ATTR void MarkRivalled(const RivalSearch& search, std::uint8_t* rivalled) {
  look(search);

  const DLook d4;
  const auto looking = [&](std::size_t i) { return search.cell_of_fly[i] != 0; };
  for (const auto i : list(search, looking)) {
    float* cell = &search.fittest[search.cell_of_fly[i]].fitness;
    const auto own = hn::LoadU(d4, &search.looks[i].fitness), other = hn::LoadU(d4, cell);
    const auto fitter = hn::Gt(hn::Broadcast<0>(own), hn::Broadcast<0>(other));
    hn::StoreU(hn::IfThenElse(fitter, own, other), d4, cell);
  }

  // All conditions on a rival at once, of several cells at once: fitness, u, v, disparity, fitness, u, ...
  const D d;
  const float margins[kLookLanes] = {search.margin, 1.0F, 1.0F, 1.0F};
  const float bounds[kLookLanes] = {0.0F, search.reach_u_px, search.reach_v_px, search.disparity_gap_px};
  const std::int32_t magnitudes[kLookLanes] = {-1, 0x7fffffff, 0x7fffffff, 0x7fffffff};  // the sign of a fitness counts
  constexpr std::uint64_t kBeyond = 0b1001;  // what must exceed its bound: fitness and disparity
  const auto margin = hn::LoadDup128(d, margins), bound = hn::LoadDup128(d, bounds);
  const auto magnitude = hn::BitCast(d, hn::LoadDup128(D32(), magnitudes));
  constexpr std::uint64_t kEach = 0x1111'1111'1111'1111;
  const auto columns = static_cast<std::ptrdiff_t>(search.cells.columns);
  for (const auto i : list(search, [&](std::size_t k) { return looking(k) & (rivalled[k] == 0); })) {
    const auto own = hn::Mul(hn::LoadDup128(d, &search.looks[i].fitness), margin);
    const Look* cells = search.fittest + search.cell_of_fly[i] - 1;
    std::uint64_t met = 0;
    for (const std::ptrdiff_t row : {-columns, std::ptrdiff_t{0}, columns}) {
      std::uint64_t beyond = 0;
      for (std::size_t k = 0; k < kColumns * kLookLanes; k += kLanes) {
        const auto difference = hn::Sub(hn::LoadU(d, &cells[row].fitness + k), own);
        const auto exceeds = hn::Gt(hn::And(difference, magnitude), bound);
        beyond |= bits_of(exceeds) << k;
      }
      const std::uint64_t as_wanted = beyond ^ ~(kBeyond * kEach);
      const std::uint64_t pairs = as_wanted & (as_wanted >> 1);
      met |= pairs & (pairs >> 2) & kEach & 0xffff;
    }
    rivalled[i] = met != 0;
  }

  for (std::size_t i = 0; i < search.flies; ++i) search.fittest[search.cell_of_fly[i]].fitness = 0.0F;
}

#endif
}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(MarkRivalled);

void mark_rivalled(const RivalSearch& search, std::uint8_t* rivalled) {
  HWY_DYNAMIC_DISPATCH(MarkRivalled)(search, rivalled);
}

}  // namespace flies::kernels
#endif
