#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flies/scan/scan_options.hpp"

namespace flies {

/// What each label of each column costs, column by column. The last label stands for no obstacle.
struct LabelCosts {
  std::span<const float> cost;
  int columns = 0;
  int labels = 0;
};

/// Memory of `find_best_path`.
struct PathMemory {
  std::vector<float> before, now;
  std::vector<std::uint16_t> origin, step;
  std::vector<int> label;  ///< the result: of each column
};

/// The cheapest choice of a label for each column: the sum of their costs and of the steps between neighbours, which
/// cost `slant` a pixel of disparity, at most `jump`, and `end` to and from no obstacle. Exact (dynamic programming).
/// @returns one label a column, in `memory`
std::vector<int>& find_best_path(const LabelCosts& costs, const EvidenceOptions& options, PathMemory& memory);

}  // namespace flies
