#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace flies {

/// Optimal assignment of rows to columns by the Hungarian algorithm (Kuhn 1955; shortest augmenting paths as Jonker
/// and Volgenant 1987): the sum of the costs is least, where a row may stay alone at a price.
/// @param costs    row by row, `rows * columns` of them; one that is not finite forbids the pairing
/// @param alone_costs one a row: the price of a row without a column; a row stays alone where that is not finite
/// @returns a row's column, or -1
std::vector<int> assign_optimally(std::span<const double> costs, std::size_t rows, std::size_t columns,
                                  std::span<const double> alone_costs);

}  // namespace flies
