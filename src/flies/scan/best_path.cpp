#include "flies/scan/best_path.hpp"

#include <algorithm>
#include <cstddef>

namespace flies {

std::vector<int>& find_best_path(const LabelCosts& costs, const EvidenceOptions& options, PathMemory& memory) {
  const auto labels = static_cast<std::size_t>(costs.labels), none = labels - 1;
  const auto columns = static_cast<std::size_t>(costs.columns);
  auto& [before, now, origin, step, label] = memory;
  before.resize(labels);
  now.resize(labels);
  step.resize(labels);
  origin.resize(labels * columns);
  label.assign(columns, 0);
  if (columns == 0) return label;
  const auto slant = static_cast<float>(options.slant), jump = static_cast<float>(options.jump),
             end = static_cast<float>(options.end);

  std::copy_n(costs.cost.begin(), labels, before.begin());
  for (std::size_t column = 1; column < columns; ++column) {
    // The cheapest obstacle so far, from which any other may be jumped to.
    const auto cheapest = static_cast<std::uint16_t>(
        std::min_element(before.begin(), before.begin() + static_cast<std::ptrdiff_t>(none)) - before.begin());
    const float lowest = std::min(before[cheapest], before[none]);
    for (std::size_t k = 0; k < labels; ++k) {
      now[k] = before[k] - lowest;
      step[k] = static_cast<std::uint16_t>(k);
    }
    const auto slide = [&](std::size_t to, std::size_t from) {
      if (!(now[from] + slant < now[to])) return;
      now[to] = now[from] + slant;
      step[to] = step[from];
    };
    for (std::size_t k = 1; k < none; ++k) slide(k, k - 1);
    for (std::size_t k = none; k-- > 1;) slide(k - 1, k);
    const auto cost = costs.cost.subspan(column * labels, labels);
    const auto reach = [&](std::size_t to, std::uint16_t from, float price) {
      if (!(before[from] - lowest + price < now[to])) return;
      now[to] = before[from] - lowest + price;
      step[to] = from;
    };
    for (std::size_t k = 0; k < none; ++k) {
      reach(k, cheapest, jump);
      reach(k, static_cast<std::uint16_t>(none), end);
    }
    reach(none, cheapest, end);
    for (std::size_t k = 0; k < labels; ++k) now[k] += cost[k];
    std::copy(step.begin(), step.end(), origin.begin() + static_cast<std::ptrdiff_t>(column * labels));
    std::swap(before, now);
  }
  auto best = static_cast<std::size_t>(std::min_element(before.begin(), before.end()) - before.begin());
  for (std::size_t column = columns; column-- > 0;) {
    label[column] = static_cast<int>(best);
    if (column > 0) best = origin[column * labels + best];
  }
  return label;
}

}  // namespace flies
