#include "flies/classify/hog_blocks.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "flies/classify/kernels/orientations.hpp"

namespace flies {
namespace {

using kernels::kBinsAside;
using kernels::kRowPadding;
using kernels::kRowsAtOnce;

constexpr std::size_t rounded_up(std::size_t size, std::size_t step) { return (size + step - 1) / step * step; }

/// Weights of a block's pixels for one of its cells along one axis: those that are not zero.
struct AxisWeights {
  int first = 0;  ///< pixel of the block
  std::vector<float> values;

  float at(int pixel) const {
    const int i = pixel - first;
    return i >= 0 && i < static_cast<int>(values.size()) ? values[static_cast<std::size_t>(i)] : 0.0F;
  }

  /// Each as often as bins stand side by side, filled up with zeros to whole vectors.
  std::vector<float> aside() const {
    std::vector<float> repeated;
    for (const float value : values) repeated.insert(repeated.end(), kBinsAside, value);
    repeated.resize(rounded_up(repeated.size(), kRowPadding), 0.0F);
    return repeated;
  }
};

/// Weight of every pixel of a block for every of its cells along one axis: Gaussian about the middle of the block times
/// linear interpolation between the middles of the cells. Both factor into axes, and so the histogram of a cell is a
/// sum over columns of sums over rows. Values as in `cv::HOGDescriptor`.
std::vector<AxisWeights> axis_weights(const HogGeometry& geometry) {
  const int cells = geometry.block_px / geometry.cell_px;
  const double sigma_px = geometry.block_px / 4.0;
  std::vector<AxisWeights> weights(static_cast<std::size_t>(cells));
  for (int c = 0; c < cells; ++c) {
    AxisWeights& of_cell = weights[static_cast<std::size_t>(c)];
    for (int i = 0; i < geometry.block_px; ++i) {
      const double from_middle_px = i - geometry.block_px * 0.5;
      const double gauss = std::exp(-from_middle_px * from_middle_px / (2.0 * sigma_px * sigma_px));
      const double share = 1.0 - std::abs((i + 0.5) / geometry.cell_px - 0.5 - c);
      if (share <= 0.0) continue;
      if (of_cell.values.empty()) of_cell.first = i;
      of_cell.values.push_back(static_cast<float>(gauss * share));
    }
  }
  return weights;
}

/// The histograms of all cells, from the gradients of the pixels.
class CellSums {
 public:
  CellSums(const FloatImage& pixels, const HogGeometry& geometry, HogBlocks& blocks)
      : pixels_(pixels),
        geometry_(geometry),
        weights_(axis_weights(geometry)),
        weights_aside_(weights_.size()),
        bins_(static_cast<std::size_t>(geometry.bins)),
        width_(static_cast<std::size_t>(pixels.width_px - 2 * kHogMargin_px)),
        plane_size_(rounded_up(width_, kRowPadding)),
        sums_size_(rounded_up(bins_, kBinsAside) * plane_size_),
        // Rows of blocks that have begun and are not finished: they start less than a block before the rows of pixels
        // at hand or among them.
        live_rows_((geometry.block_px + static_cast<int>(kRowsAtOnce) - 2) / geometry.stride_px + 1),
        sums_(static_cast<std::size_t>(live_rows_) * weights_.size() * sums_size_, 0.0F),
        aside_(sums_size_ + kRowPadding, 0.0F),
        blocks_(blocks) {
    std::transform(weights_.begin(), weights_.end(), weights_aside_.begin(), [](const auto& w) { return w.aside(); });
  }

  void add_up() {
    const int height = pixels_.height_px - 2 * kHogMargin_px, step = kRowsAtOnce;
    int finished = 0;
    for (int v = 0; v < height; v += step) {
      cells_.clear();
      for (int row = finished; row < blocks_.rows && row * geometry_.stride_px < v + step; ++row) note_cells(v, row);
      std::array<const float*, kRowsAtOnce + 2> rows;
      for (int r = 0; r < step + 2; ++r)  // rows below the last have no weight
        rows[static_cast<std::size_t>(r)] = pixels_.row(std::min(v + r, pixels_.height_px - 1)) + kHogMargin_px;
      kernels::add_votes(rows, width_, geometry_.bins, plane_size_, cells_);
      for (; finished < blocks_.rows && finished * geometry_.stride_px + geometry_.block_px <= v + step; ++finished)
        finish(finished);
    }
  }

 private:
  float* sums_of(int row, std::size_t cell) {
    return sums_.data() + (static_cast<std::size_t>(row % live_rows_) * weights_.size() + cell) * sums_size_;
  }

  /// The cells of a row of blocks that the rows of pixels from v on add to.
  void note_cells(int v, int row) {
    for (std::size_t cell = 0; cell < weights_.size(); ++cell) {
      kernels::CellRow to{sums_of(row, cell), {}};
      for (int r = 0; r < static_cast<int>(kRowsAtOnce); ++r)
        to.weights[static_cast<std::size_t>(r)] = weights_[cell].at(v + r - row * geometry_.stride_px);
      if (std::any_of(to.weights.begin(), to.weights.end(), [](float weight) { return weight > 0.0F; }))
        cells_.push_back(to);
    }
  }

  /// The other axis: columns to cells, and the sums are free for another row.
  void finish(int row) {
    const std::size_t cells = weights_.size();
    for (std::size_t cell_v = 0; cell_v < cells; ++cell_v) {
      float* const sums = sums_of(row, cell_v);
      for (std::size_t bin = 0; bin < bins_; bin += kBinsAside)
        kernels::interleave(sums + bin * plane_size_, plane_size_, aside_.data() + bin * plane_size_);
      std::fill_n(sums, bins_ * plane_size_, 0.0F);
      for (std::size_t cell_u = 0; cell_u < cells; ++cell_u)
        for (std::size_t bin = 0; bin < bins_; bin += kBinsAside) add_columns(row, cell_u, cell_v, bin);
    }
    for (int column = 0; column < blocks_.columns; ++column)
      kernels::normalise_block(blocks_.block(column, row), blocks_.block_size);
  }

  /// Four bins of one cell of every block of a row.
  void add_columns(int row, std::size_t cell_u, std::size_t cell_v, std::size_t bin) {
    const std::vector<float>& weights = weights_aside_[cell_u];
    kernels::add_columns(
        aside_.data() + bin * plane_size_ + kBinsAside * static_cast<std::size_t>(weights_[cell_u].first),
        weights.data(), weights.size() / kBinsAside, static_cast<std::size_t>(geometry_.stride_px),
        static_cast<std::size_t>(blocks_.columns), std::min(kBinsAside, bins_ - bin),
        static_cast<std::size_t>(blocks_.rows) * blocks_.block_size,
        blocks_.block(0, row) + (cell_u * weights_.size() + cell_v) * bins_ + bin);
  }

  const FloatImage& pixels_;
  const HogGeometry& geometry_;
  std::vector<AxisWeights> weights_;
  std::vector<std::vector<float>> weights_aside_;
  std::size_t bins_, width_, plane_size_, sums_size_;
  int live_rows_;
  std::vector<float> sums_;              ///< of the rows of cells in the live rows of blocks, a plane a bin
  std::vector<float> aside_;             ///< of one row of cells, four bins side by side
  std::vector<kernels::CellRow> cells_;  ///< that the rows of pixels at hand add to
  HogBlocks& blocks_;
};

}  // namespace

HogBlocks hog_blocks(FloatImage pixels, const HogGeometry& geometry) {
  const std::size_t count = pixels.values.size();
  static_assert(kSparePixels >= 2 * kRowPadding);
  pixels.values.resize(rounded_up(count, kRowPadding) + kRowPadding, 0.0F);
  if (geometry.gamma) kernels::square_roots(pixels.values.data(), count);
  const auto blocks_along = [&](int size_px) {
    size_px -= 2 * kHogMargin_px;
    assert(size_px >= geometry.block_px && (size_px - geometry.block_px) % geometry.stride_px == 0);
    return (size_px - geometry.block_px) / geometry.stride_px + 1;
  };
  const auto cells = static_cast<std::size_t>(geometry.block_px / geometry.cell_px);
  HogBlocks blocks{blocks_along(pixels.width_px),
                   blocks_along(pixels.height_px),
                   cells * cells * static_cast<std::size_t>(geometry.bins),
                   {}};
  blocks.values.resize(static_cast<std::size_t>(blocks.columns) * static_cast<std::size_t>(blocks.rows) *
                       blocks.block_size);
  CellSums(pixels, geometry, blocks).add_up();
  return blocks;
}

}  // namespace flies
