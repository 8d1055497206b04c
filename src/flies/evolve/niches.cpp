#include "flies/evolve/niches.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <functional>

namespace flies {

using kernels::Cells;

void find_crowding(const ImagePopulation& flies, int width_px, int height_px, int cell_px, CrowdingGrid& grid,
                   std::vector<float>& crowding) {
  const Cells cells(width_px, height_px, cell_px, cell_px);
  grid.counts.resize(cells.size());
  grid.cell_of_fly.resize(flies.size());
  crowding.resize(flies.size());
  for (std::size_t i = 0; i < flies.size(); ++i) {
    grid.cell_of_fly[i] = cells.cell(flies.u_px[i], flies.v_px[i]);
    ++grid.counts[grid.cell_of_fly[i]];
  }
  grid.counts[0] = 0;
  for (std::size_t i = 0; i < flies.size(); ++i) {
    const auto* own = grid.counts.data() + grid.cell_of_fly[i];
    crowding[i] = grid.cell_of_fly[i] == 0
                      ? 1.0F
                      : static_cast<float>(own[0]) +
                            0.5F * static_cast<float>(own[-1] + own[1] + *(own - cells.columns) + own[cells.columns]);
  }
  // Touches only the cells where flies are, however large the image is.
  for (const auto cell : grid.cell_of_fly) grid.counts[cell] = 0;
}

void share_fitness(std::span<const float> fitness, std::span<const float> crowding, double strength,
                   std::vector<float>& shared) {
  assert(fitness.size() == crowding.size());
  shared.assign(fitness.begin(), fitness.end());
  if (strength == 0.0) return;
  for (std::size_t i = 0; i < shared.size(); ++i)
    shared[i] /= strength == 1.0 ? crowding[i] : std::pow(crowding[i], static_cast<float>(strength));
}

void find_rivalled(const ImagePopulation& flies, int width_px, int height_px, const UniquenessOptions& options,
                   UniquenessGrid& grid, std::vector<std::uint8_t>& rivalled) {
  const Cells cells(width_px, height_px, options.reach_u_px, options.reach_v_px);
  for (auto& memory : grid.searches) {
    memory.fittest.resize(cells.size() + 2);
    memory.looks.resize(flies.size());
    memory.cell_of_fly.resize(flies.size());
    memory.listed.resize(flies.size() + 1);
    memory.rivalled.assign(flies.size(), 0);
  }
  // The two searches, in the left and in the right image, run side by side where there are two threads, each in its own
  // memory. On one thread they run in turn, both in the first one's memory: it is in the caches already, and flies that
  // the first search marked there are skipped by the second.
  std::atomic<bool> first_memory_is_taken = false;
  const auto search = [&](float shift) {
    const bool has_first_memory = !first_memory_is_taken.exchange(true);
    auto& memory = grid.searches[has_first_memory ? 0 : 1];
    kernels::mark_rivalled({.fitness = flies.fitness.data(),
                            .u_px = flies.u_px.data(),
                            .v_px = flies.v_px.data(),
                            .disparity_px = flies.disparity_px.data(),
                            .flies = flies.size(),
                            .shift = shift,
                            .cells = cells,
                            .reach_u_px = static_cast<float>(options.reach_u_px),
                            .reach_v_px = static_cast<float>(options.reach_v_px),
                            .disparity_gap_px = static_cast<float>(options.disparity_px),
                            .margin = static_cast<float>(options.margin),
                            .looks = memory.looks.data(),
                            .cell_of_fly = memory.cell_of_fly.data(),
                            .listed = memory.listed.data(),
                            .fittest = memory.fittest.data()},
                           memory.rivalled.data());
    if (has_first_memory) first_memory_is_taken = false;
  };
  tbb::parallel_invoke([&] { search(0.0F); }, [&] { search(1.0F); });
  const auto& [first, second] = grid.searches;
  rivalled.resize(flies.size());
  std::transform(first.rivalled.begin(), first.rivalled.end(), second.rivalled.begin(), rivalled.begin(),
                 std::bit_or<std::uint8_t>());
}

void select_fittest(std::span<const float> fitness, std::size_t count, std::vector<std::uint32_t>& fittest) {
  count = std::min(count, fitness.size());
  fittest.resize(count);
  if (count == 0) return;
  // Radix select: the bits of floats >= 0 order like the floats. Finds the bits of the value at rank `count`, some at a
  // time from the top, and how many of the values equal to it are wanted.
  const auto key = [&](std::size_t i) { return std::bit_cast<std::uint32_t>(fitness[i]); };
  constexpr int kBits = 11;
  std::uint32_t least = 0;
  std::size_t wanted = count;
  for (const int shift : {21, 10, 0}) {
    const int bits = shift == 0 ? 10 : kBits;
    std::array<std::uint32_t, 1 << kBits> histogram{};
    const std::uint64_t known = std::uint64_t{least} >> (shift + bits);
    for (std::size_t i = 0; i < fitness.size(); ++i)
      if (std::uint64_t{key(i)} >> (shift + bits) == known) ++histogram[(key(i) >> shift) & ((1u << bits) - 1)];
    auto digit = (1u << bits) - 1;
    while (wanted > histogram[digit]) wanted -= histogram[digit--];
    least |= digit << shift;
  }
  std::size_t found = 0;
  for (std::size_t i = 0; found < count; ++i) {
    const bool equal = key(i) == least && wanted > 0;
    wanted -= equal ? 1 : 0;
    fittest[found] = static_cast<std::uint32_t>(i);
    found += key(i) > least || equal ? 1 : 0;
  }
}

}  // namespace flies
