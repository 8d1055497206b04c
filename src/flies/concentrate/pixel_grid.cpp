#include "flies/concentrate/pixel_grid.hpp"

#include <algorithm>
#include <limits>

namespace flies {
namespace {

/// Cells to a reach. Cells of a row follow each other, so that narrow ones cost little and spare many visits.
constexpr double kColumnsAReach = 4.0, kRowsAReach = 1.0;

/// Flies far outside an image make a large grid: then its cells are larger.
constexpr std::size_t kMaxColumns = 1024, kMaxRows = 128;

/// The cell of a coordinate, and the nearest one of a coordinate outside the grid; the first if it is not a number.
std::size_t cell_at(double from_edge_px, double cells_per_px, std::size_t cells) {
  return static_cast<std::size_t>(std::max(0.0, std::min(from_edge_px * cells_per_px, static_cast<double>(cells - 1))));
}

}  // namespace

void PixelGrid::reserve(std::size_t flies) {
  starts_.reserve(kMaxColumns * kMaxRows + 2);
  for (auto* values : {&u_px_, &v_px_, &fitness_}) values->reserve(flies + kernels::kPadding);
  for (auto* values : {&cell_of_fly_, &index_}) values->reserve(flies + kernels::kPadding);
}

void PixelGrid::lay_out(std::span<const DroppedFly> flies, double reach_px) {
  constexpr double kLowest = std::numeric_limits<double>::lowest(), kHighest = std::numeric_limits<double>::max();
  double max_u = kLowest, max_v = kLowest;
  min_u_px_ = min_v_px_ = kHighest;
  for (const auto& fly : flies) {
    if (!(fly.fitness > 0.0)) continue;
    min_u_px_ = std::min(min_u_px_, fly.pixel.u_px);
    min_v_px_ = std::min(min_v_px_, fly.pixel.v_px);
    max_u = std::max(max_u, fly.pixel.u_px);
    max_v = std::max(max_v, fly.pixel.v_px);
  }
  const double width_px = std::max(0.0, max_u - min_u_px_), height_px = std::max(0.0, max_v - min_v_px_);
  columns_per_px_ = std::min(kColumnsAReach / reach_px, (kMaxColumns - 1) / (width_px + 1.0));
  rows_per_px_ = std::min(kRowsAReach / reach_px, (kMaxRows - 1) / (height_px + 1.0));
  columns_ = static_cast<std::size_t>(width_px * columns_per_px_) + 1;
  rows_ = static_cast<std::size_t>(height_px * rows_per_px_) + 1;
}

inline std::size_t PixelGrid::column(double u_px) const { return cell_at(u_px - min_u_px_, columns_per_px_, columns_); }

inline std::size_t PixelGrid::row(double v_px) const { return cell_at(v_px - min_v_px_, rows_per_px_, rows_); }

void PixelGrid::fill(std::span<const DroppedFly> flies, double reach_px) {
  lay_out(flies, reach_px);
  // Counting sort. While flies move in, starts_[c + 1] is where the next fly of cell c goes; in the end it is where
  // those of cell c + 1 start.
  starts_.assign(columns_ * rows_ + 2, 0);
  cell_of_fly_.resize(flies.size());
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < flies.size(); ++i) {
    const auto& [pixel, fitness] = flies[i];
    cell_of_fly_[i] = kNoCell;
    if (!(fitness > 0.0)) continue;
    cell_of_fly_[i] = static_cast<std::uint32_t>(row(pixel.v_px) * columns_ + column(pixel.u_px));
    ++starts_[cell_of_fly_[i] + 2];
    ++count;
  }
  for (std::size_t c = 2; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
  for (auto* values : {&u_px_, &v_px_, &fitness_}) values->resize(count + kernels::kPadding);
  index_.resize(count + kernels::kPadding);
  for (std::size_t i = 0; i < flies.size(); ++i) {
    if (cell_of_fly_[i] == kNoCell) continue;
    const auto place = starts_[cell_of_fly_[i] + 1]++;
    u_px_[place] = flies[i].pixel.u_px;
    v_px_[place] = flies[i].pixel.v_px;
    fitness_[place] = flies[i].fitness;
    index_[place] = static_cast<std::uint32_t>(i);
  }
}

kernels::PointRuns PixelGrid::near(const PixelPoint& p, double reach_px) const {
  const std::size_t left = column(p.u_px - reach_px), right = column(p.u_px + reach_px);
  const std::size_t top = row(p.v_px - reach_px), bottom = row(p.v_px + reach_px);
  return {.u_px = u_px_.data(),
          .v_px = v_px_.data(),
          .weight = fitness_.data(),
          .starts = starts_.data() + top * columns_ + left,
          .stride = columns_,
          .cells = right + 1 - left,
          .runs = bottom + 1 - top};
}

}  // namespace flies
