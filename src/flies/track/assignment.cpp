#include "flies/track/assignment.hpp"

#include <cassert>
#include <cmath>
#include <limits>

namespace flies {

std::vector<int> assign_optimally(std::span<const double> costs, std::size_t rows, std::size_t columns,
                                  std::span<const double> alone_costs) {
  assert(costs.size() == rows * columns && alone_costs.size() == rows);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // Each row has a column of its own in which it is alone, so a complete assignment always exists. A pairing dearer
  // than staying alone is never part of the best, hence forbidden ones need no number of their own.
  const std::size_t all = columns + rows;
  const auto cost = [&](std::size_t row, std::size_t column) {
    if (column >= columns) return column - columns == row ? alone_costs[row] : kInfinity;
    const double c = costs[row * columns + column];
    return std::isfinite(c) && c < alone_costs[row] ? c : kInfinity;
  };

  // Rows and columns count from 1; column 0 holds the row that is being placed.
  std::vector<double> row_potential(rows + 1, 0.0), column_potential(all + 1, 0.0);
  std::vector<std::size_t> row_of(all + 1, 0), way(all + 1, 0);
  for (std::size_t row = 1; row <= rows; ++row) {
    if (!std::isfinite(alone_costs[row - 1])) continue;  // no number to compare with: it stays alone
    row_of[0] = row;
    std::size_t column = 0;
    std::vector<double> least(all + 1, kInfinity);
    std::vector<bool> used(all + 1, false);
    do {
      used[column] = true;
      const std::size_t from = row_of[column];
      double delta = kInfinity;
      std::size_t next = 0;
      for (std::size_t j = 1; j <= all; ++j) {
        if (used[j]) continue;
        const double reduced = cost(from - 1, j - 1) - row_potential[from] - column_potential[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          way[j] = column;
        }
        if (least[j] < delta) {
          delta = least[j];
          next = j;
        }
      }
      assert(next != 0);
      for (std::size_t j = 0; j <= all; ++j) {
        if (used[j]) {
          row_potential[row_of[j]] += delta;
          column_potential[j] -= delta;
        } else {
          least[j] -= delta;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    while (column != 0) {
      row_of[column] = row_of[way[column]];
      column = way[column];
    }
  }

  std::vector<int> column_of(rows, -1);
  for (std::size_t j = 1; j <= columns; ++j)
    if (row_of[j] != 0) column_of[row_of[j] - 1] = static_cast<int>(j - 1);
  return column_of;
}

}  // namespace flies
