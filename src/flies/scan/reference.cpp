#include "flies/scan/reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace flies {
namespace {

using kernels::CellMatch;
using kernels::CellMatching;

constexpr int kNever = 255;

/// Sobel's horizontal gradient, halved and clipped, from 0 on.
int gradient(const GrayView& image, int u, int v, int max) {
  if (u <= 0 || u >= image.width_px - 1) return max;
  int sum = 0;
  for (const int row : {-1, 0, 0, 1}) sum += image.at(u + 1, v + row) - image.at(u - 1, v + row);
  return static_cast<int>(std::floor((std::clamp(sum, -2 * max, 2 * max) + 2 * max) / 2.0));
}

/// Half the sum of absolute differences over the cell, each pair of rows by itself, rounded up; at most `max_cost`.
int cell_cost(const CellMatching& m, int band, int column, int disparity_px) {
  const int first = column * kernels::kCellColumns, last = first + kernels::kCellColumns - 1;
  if (first - disparity_px < 0 || last - disparity_px >= m.pair.right.width_px) return m.weights.max_cost;
  int sum = 0;
  for (int row = 0; row < kernels::kCellRows; ++row) {
    const int v = m.bottom_row - (band * kernels::kCellRows + row) * m.row_step;
    for (int u = first; u <= last; ++u)
      sum += std::abs(gradient(m.pair.left, u, v, m.weights.max_gradient) -
                      gradient(m.pair.right, u - disparity_px, v, m.weights.max_gradient));
  }
  return std::min((sum + 1) / 2, m.weights.max_cost);
}

/// One value a cell and disparity.
class Volume {
 public:
  Volume(const CellMatching& m, int value)
      : m_(m), values_(m.cells() * static_cast<std::size_t>(m.disparities), value) {}
  int& at(int band, int column, int k) {
    return values_[static_cast<std::size_t>((band * m_.columns + column) * m_.disparities + k)];
  }

 private:
  const CellMatching& m_;
  std::vector<int> values_;
};

/// Adds to `detour` what the paths that come from the cell (band - up, column - across) add.
void follow_paths(const CellMatching& m, int up, int across, Volume& cost, Volume& detour) {
  Volume path(m, 0);
  const int slant = up != 0 ? m.weights.slant_upward : m.weights.slant_across;
  for (int i = 0; i < m.bands; ++i)
    for (int j = 0; j < m.columns; ++j) {
      const int band = up < 0 ? m.bands - 1 - i : i, column = across < 0 ? m.columns - 1 - j : j;
      const int from_band = band - up, from_column = column - across;
      const bool is_first = from_band < 0 || from_band >= m.bands || from_column < 0 || from_column >= m.columns;
      const int reach = m.reach[static_cast<std::size_t>(band)];
      if (is_first) {
        for (int k = 0; k < reach; ++k) path.at(band, column, k) = cost.at(band, column, k);
        continue;
      }
      const int from_reach = m.reach[static_cast<std::size_t>(from_band)];
      int least = kNever;
      for (int k = 0; k < from_reach; ++k) least = std::min(least, path.at(from_band, from_column, k));
      const auto before = [&](int k) {
        return k < 0 || k >= from_reach ? kNever : path.at(from_band, from_column, k) - least;
      };
      const int road = up > 0   ? -m.recede[static_cast<std::size_t>(from_band)]
                       : up < 0 ? m.recede[static_cast<std::size_t>(band)]
                                : 0;
      for (int k = 0; k < reach; ++k) {
        const int added =
            std::min({before(k), before(k + road), before(k - 1) + slant, before(k + 1) + slant, m.weights.jump});
        detour.at(band, column, k) += added;
        path.at(band, column, k) = cost.at(band, column, k) + added;
      }
    }
}

CellMatch choose(const CellMatching& m, int band, int column, Volume& cost, Volume& detour) {
  const int reach = m.reach[static_cast<std::size_t>(band)];
  const auto sum = [&](int k) {
    return k < 0 || k >= reach ? kNever : std::min(kNever, cost.at(band, column, k) + detour.at(band, column, k));
  };
  int best = 0;
  for (int k = 1; k < reach; ++k)
    if (sum(k) < sum(best)) best = k;
  int second = kNever;
  for (int k = 0; k < reach; ++k)
    if (std::abs(k - best) > 2) second = std::min(second, sum(k));
  const auto byte = [](int value) { return static_cast<std::uint8_t>(value); };
  return {static_cast<std::uint16_t>(best), byte(sum(best - 1)), byte(sum(best)), byte(sum(best + 1)), byte(second)};
}

}  // namespace

std::vector<CellMatch> match_cells_reference(const CellMatching& m) {
  Volume cost(m, kNever), detour(m, 0);
  for (int band = 0; band < m.bands; ++band)
    for (int column = 0; column < m.columns; ++column)
      for (int k = 0; k < m.reach[static_cast<std::size_t>(band)]; ++k)
        cost.at(band, column, k) = cell_cost(m, band, column, m.nearest_px - k);
  for (const auto& [up, across] : {std::pair(0, 1), std::pair(0, -1), std::pair(1, 0), std::pair(-1, 0)})
    follow_paths(m, up, across, cost, detour);
  std::vector<CellMatch> matches;
  for (int band = 0; band < m.bands; ++band)
    for (int column = 0; column < m.columns; ++column) matches.push_back(choose(m, band, column, cost, detour));
  return matches;
}

}  // namespace flies
