#include <cmath>
#include <initializer_list>

#include "flies/evolve/kernels/rivals.hpp"

namespace flies::kernels {
namespace {

bool is_rival(const RivalSearch& search, const Look& own, const Look& other) {
  return other.fitness > search.margin * own.fitness &&
         std::abs(other.disparity_px - own.disparity_px) > search.disparity_gap_px &&
         std::abs(other.u_px - own.u_px) <= search.reach_u_px && std::abs(other.v_px - own.v_px) <= search.reach_v_px;
}

}  // namespace

void mark_rivalled_scalar(const RivalSearch& search, std::uint8_t* rivalled) {
  for (std::size_t i = 0; i < search.flies; ++i) {
    const Look own{search.fitness[i], search.u_px[i] - search.shift * search.disparity_px[i], search.v_px[i],
                   search.disparity_px[i]};
    const auto cell = own.fitness > 0.0F ? search.cells.cell(own.u_px, own.v_px) : 0;
    search.looks[i] = own;
    search.cell_of_fly[i] = cell;
    if (cell != 0 && own.fitness > search.fittest[cell].fitness) search.fittest[cell] = own;
  }
  const auto columns = static_cast<std::ptrdiff_t>(search.cells.columns);
  for (std::size_t i = 0; i < search.flies; ++i) {
    if (search.cell_of_fly[i] == 0 || rivalled[i] != 0) continue;
    const Look* own_cell = search.fittest + search.cell_of_fly[i];
    for (const auto row : {-columns, std::ptrdiff_t{0}, columns})
      for (const std::ptrdiff_t column : {-1, 0, 1})
        if (is_rival(search, search.looks[i], own_cell[row + column])) rivalled[i] = 1;
  }
  for (std::size_t i = 0; i < search.flies; ++i) search.fittest[search.cell_of_fly[i]].fitness = 0.0F;
}

}  // namespace flies::kernels
