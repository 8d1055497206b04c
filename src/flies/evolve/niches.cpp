#include "flies/evolve/niches.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

namespace flies {
namespace {

/// Cells over an image, with a margin of one cell so that the neighbours of border cells need no test. Cell 0 is in the
/// margin and stands for places outside.
class Cells {
 public:
  Cells(int width_px, int height_px, double cell_width_px, double cell_height_px)
      : per_u_(static_cast<float>(1.0 / cell_width_px)),
        per_v_(static_cast<float>(1.0 / cell_height_px)),
        width_px_(static_cast<float>(width_px)),
        height_px_(static_cast<float>(height_px)),
        columns_(static_cast<std::uint32_t>(width_px / cell_width_px) + 3),
        rows_(static_cast<std::uint32_t>(height_px / cell_height_px) + 3) {}

  std::size_t size() const { return std::size_t{columns_} * rows_; }
  std::uint32_t columns() const { return columns_; }

  std::uint32_t cell(float u_px, float v_px) const {
    if (!(u_px >= 0.0F && u_px <= width_px_ - 1 && v_px >= 0.0F && v_px <= height_px_ - 1)) return 0;
    return (static_cast<std::uint32_t>(static_cast<std::int32_t>(v_px * per_v_)) + 1) * columns_ +
           static_cast<std::uint32_t>(static_cast<std::int32_t>(u_px * per_u_)) + 1;
  }

 private:
  float per_u_, per_v_, width_px_, height_px_;
  std::uint32_t columns_, rows_;
};

}  // namespace

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
    crowding[i] = grid.cell_of_fly[i] == 0 ? 1.0F
                                           : static_cast<float>(own[0]) +
                                                 0.5F * static_cast<float>(own[-1] + own[1] + *(own - cells.columns()) +
                                                                           own[cells.columns()]);
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

namespace {

/// One of the two images, in which a fly looks at column u minus `shift` times its disparity.
void mark_rivalled(const ImagePopulation& flies, float shift, const Cells& cells, const UniquenessOptions& options,
                   UniquenessGrid& grid, std::vector<std::uint8_t>& rivalled) {
  using Look = UniquenessGrid::Look;
  const auto look = [&](std::size_t i) {
    return Look{flies.fitness[i], flies.u_px[i] - shift * flies.disparity_px[i], flies.v_px[i], flies.disparity_px[i]};
  };
  for (std::size_t i = 0; i < flies.size(); ++i) {
    const Look own = look(i);
    const auto cell = own.fitness > 0.0F ? cells.cell(own.u_px, own.v_px) : 0;
    grid.cell_of_fly[i] = cell;
    if (cell != 0 && own.fitness > grid.fittest[cell].fitness) grid.fittest[cell] = own;
  }
  const auto margin = static_cast<float>(options.margin);
  const auto reach_u_px = static_cast<float>(options.reach_u_px), reach_v_px = static_cast<float>(options.reach_v_px);
  const auto disparity_px = static_cast<float>(options.disparity_px);
  // Cells are one reach wide, so nine of them cover the reach.
  const auto has_rival = [&](const Look& own, std::uint32_t cell) {
    const float fitness = margin * own.fitness;
    for (const auto first : {cell - cells.columns() - 1, cell - 1, cell + cells.columns() - 1})
      for (auto k = first; k != first + 3; ++k) {
        const Look& other = grid.fittest[k];
        if (other.fitness > fitness && std::abs(other.disparity_px - own.disparity_px) > disparity_px &&
            std::abs(other.u_px - own.u_px) <= reach_u_px && std::abs(other.v_px - own.v_px) <= reach_v_px)
          return true;
      }
    return false;
  };
  for (std::size_t i = 0; i < flies.size(); ++i)
    if (const auto cell = grid.cell_of_fly[i]; cell != 0 && rivalled[i] == 0) rivalled[i] = has_rival(look(i), cell);
  for (const auto cell : grid.cell_of_fly) grid.fittest[cell].fitness = 0.0F;
}

}  // namespace

void find_rivalled(const ImagePopulation& flies, int width_px, int height_px, const UniquenessOptions& options,
                   UniquenessGrid& grid, std::vector<std::uint8_t>& rivalled) {
  const Cells cells(width_px, height_px, options.reach_u_px, options.reach_v_px);
  grid.fittest.resize(cells.size());
  grid.cell_of_fly.resize(flies.size());
  rivalled.assign(flies.size(), 0);
  mark_rivalled(flies, 0.0F, cells, options, grid, rivalled);
  mark_rivalled(flies, 1.0F, cells, options, grid, rivalled);
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
