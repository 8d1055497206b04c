#include "flies/classify/hog_blocks.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "flies/classify/dot.hpp"
#include "flies/classify/vector_clones.hpp"

namespace flies {
namespace {

/// Floats kept for the orientations of a column: whole vectors. Nine are the rule, 64 the most that a geometry has.
constexpr std::size_t kFewBins = 12, kManyBins = 64;

/// What the pixels of a row vote for: a share of their gradient's magnitude for the orientation below their own, the
/// rest for the one above.
struct RowVotes {
  std::vector<std::int32_t> lower, upper;  ///< column times `bin_stride` plus orientation
  std::vector<float> for_lower, for_upper;
  std::vector<float> magnitude, place;

  explicit RowVotes(std::size_t width)
      : lower(width), upper(width), for_lower(width), for_upper(width), magnitude(width), place(width) {}
};

/// Angle of (x, y) above the x axis over pi, where y is not negative: 0 to 1. Polynomial of OpenCV's fastAtan2, off by
/// less than 0.01 degrees.
inline float half_turns(float x, float y) {
  constexpr float kTiny = 1e-20F;
  const float ax = std::abs(x);
  const float ratio = std::min(ax, y) / (std::max(ax, y) + kTiny);
  const float square = ratio * ratio;
  constexpr auto kPi = static_cast<float>(std::numbers::pi);
  const float turn = (((-0.04432655554792128F * square + 0.1555786518463281F) * square - 0.3258083974640975F) * square +
                      0.9997878412794807F) *
                     ratio / kPi;
  const float acute = y > ax ? 0.5F - turn : turn;
  return x < 0.0F ? 1.0F - acute : acute;
}

FLIES_VECTOR_CLONES void vote(const FloatImage& pixels, int v, int bins, int bin_stride, RowVotes& votes) {
  const auto width = static_cast<int>(votes.lower.size());
  const float* const above = pixels.row(v) + 1;
  const float* const here = pixels.row(v + 1);
  const float* const below = pixels.row(v + 2) + 1;
  float* const m = votes.magnitude.data();
  float* const p = votes.place.data();
  for (int u = 0; u < width; ++u) {
    const float du = here[u + 2] - here[u], dv = below[u] - above[u];
    m[u] = std::sqrt(du * du + dv * dv);
    // Opposite gradients count as one: a light coat before a dark wall is a dark coat before a light wall.
    p[u] = half_turns(dv < 0.0F ? -du : du, std::abs(dv)) * static_cast<float>(bins) + 0.5F;
  }
  std::int32_t* const lower = votes.lower.data();
  std::int32_t* const upper = votes.upper.data();
  float* const for_lower = votes.for_lower.data();
  float* const for_upper = votes.for_upper.data();
  for (int u = 0; u < width; ++u) {
    const auto above_bin = static_cast<std::int32_t>(p[u]);  // 0 to bins: the bin whose centre lies above, of a ring
    const float share = m[u] * (p[u] - static_cast<float>(above_bin));
    upper[u] = u * bin_stride + (above_bin == bins ? 0 : above_bin);
    lower[u] = u * bin_stride + (above_bin == 0 ? bins : above_bin) - 1;
    for_upper[u] = share;
    for_lower[u] = m[u] - share;
  }
}

/// Weight of every pixel of a block for every of its cells along one axis: Gaussian about the middle of the block times
/// linear interpolation between the middles of the cells. Both factor into axes, and so the histogram of a cell is a
/// sum over columns of sums over rows. Values as in `cv::HOGDescriptor`.
std::vector<std::vector<float>> axis_weights(const HogGeometry& geometry) {
  const int cells = geometry.block_px / geometry.cell_px;
  const double sigma_px = geometry.block_px / 4.0;
  std::vector<std::vector<float>> weights(static_cast<std::size_t>(cells));
  for (int c = 0; c < cells; ++c) {
    for (int i = 0; i < geometry.block_px; ++i) {
      const double from_middle_px = i - geometry.block_px * 0.5;
      const double gauss = std::exp(-from_middle_px * from_middle_px / (2.0 * sigma_px * sigma_px));
      const double place = (i + 0.5) / geometry.cell_px - 0.5;
      weights[static_cast<std::size_t>(c)].push_back(
          static_cast<float>(gauss * std::max(0.0, 1.0 - std::abs(place - c))));
    }
  }
  return weights;
}

/// L2-Hys: unit length, no number above 0.2, unit length again. The small constants are those of `cv::HOGDescriptor`.
void normalise(float* block, std::size_t size) {
  constexpr float kClip = 0.2F;
  const float first = 1.0F / (std::sqrt(dot(block, block, size)) + 0.1F * static_cast<float>(size));
  for (std::size_t i = 0; i < size; ++i) block[i] = std::min(block[i] * first, kClip);
  const float second = 1.0F / (std::sqrt(dot(block, block, size)) + 1e-3F);
  for (std::size_t i = 0; i < size; ++i) block[i] *= second;
}

/// Where a row's votes go: the sums over the rows of one row of cells in one row of blocks.
struct Target {
  float* sums = nullptr;
  float weight = 0.0F;
};

/// A row belongs to three rows of cells in Dalal and Triggs' geometry; others fill up with targets of no weight.
constexpr std::size_t kTargets = 3;

void add_votes(const RowVotes& votes, const std::array<Target, kTargets>& targets) {
  const auto [a, b, c] = targets;
  for (std::size_t u = 0; u < votes.lower.size(); ++u) {
    const std::int32_t lower = votes.lower[u], upper = votes.upper[u];
    const float for_lower = votes.for_lower[u], for_upper = votes.for_upper[u];
    a.sums[lower] += a.weight * for_lower;
    a.sums[upper] += a.weight * for_upper;
    b.sums[lower] += b.weight * for_lower;
    b.sums[upper] += b.weight * for_upper;
    c.sums[lower] += c.weight * for_lower;
    c.sums[upper] += c.weight * for_upper;
  }
}

/// The other axis: the sums of a block's columns, weighted, to the histograms of its cells.
/// @tparam kBinStride number of floats from one column to the next, so that sums stay in registers
template <std::size_t kBinStride>
void add_columns(const float* sums, const std::vector<float>& weights, std::size_t bins, float* histogram) {
  std::array<float, kBinStride> total{};
  for (const float weight : weights) {
    for (std::size_t bin = 0; bin < kBinStride; ++bin) total[bin] += weight * sums[bin];
    sums += kBinStride;
  }
  std::copy_n(total.begin(), bins, histogram);
}

}  // namespace

HogBlocks hog_blocks(FloatImage pixels, const HogGeometry& geometry) {
  if (geometry.gamma)
    for (float& value : pixels.values) value = std::sqrt(value);
  const auto weights = axis_weights(geometry);
  const auto bins = static_cast<std::size_t>(geometry.bins), cells = weights.size();
  const std::size_t bin_stride = bins <= kFewBins ? kFewBins : kManyBins;
  const int width = pixels.width_px - 2 * kHogMargin_px, height = pixels.height_px - 2 * kHogMargin_px;
  const auto count = [&](int size_px) {
    assert(size_px >= geometry.block_px && (size_px - geometry.block_px) % geometry.stride_px == 0);
    return (size_px - geometry.block_px) / geometry.stride_px + 1;
  };
  HogBlocks blocks{count(width), count(height), cells * cells * bins, {}};

  // Rows of pixels to rows of cells. The last sums are nobody's.
  const std::size_t sums_size = static_cast<std::size_t>(width) * bin_stride;
  const std::size_t cell_rows = static_cast<std::size_t>(blocks.rows) * cells;
  std::vector<float> sums((cell_rows + 1) * sums_size, 0.0F);
  RowVotes votes(static_cast<std::size_t>(width));
  for (int v = 0; v < height; ++v) {
    vote(pixels, v, geometry.bins, static_cast<int>(bin_stride), votes);
    std::array<Target, kTargets> targets;
    targets.fill({sums.data() + cell_rows * sums_size, 0.0F});
    std::size_t used = 0;
    const int first = std::max(0, (v - geometry.block_px + geometry.stride_px) / geometry.stride_px);
    for (int row = first; row < blocks.rows && row * geometry.stride_px <= v; ++row) {
      for (std::size_t cell = 0; cell < cells; ++cell) {
        const float weight = weights[cell][static_cast<std::size_t>(v - row * geometry.stride_px)];
        if (weight == 0.0F) continue;
        targets[used++] = {sums.data() + (static_cast<std::size_t>(row) * cells + cell) * sums_size, weight};
        if (used < kTargets) continue;
        add_votes(votes, targets);
        targets.fill({sums.data() + cell_rows * sums_size, 0.0F});
        used = 0;
      }
    }
    if (used > 0) add_votes(votes, targets);
  }

  // Columns of pixels to cells, cells to blocks.
  blocks.values.resize(static_cast<std::size_t>(blocks.columns) * static_cast<std::size_t>(blocks.rows) *
                       blocks.block_size);
  float* block = blocks.values.data();
  for (int column = 0; column < blocks.columns; ++column) {
    for (int row = 0; row < blocks.rows; ++row, block += blocks.block_size) {
      for (std::size_t cell_v = 0; cell_v < cells; ++cell_v) {
        const float* const of_row = sums.data() + (static_cast<std::size_t>(row) * cells + cell_v) * sums_size +
                                    static_cast<std::size_t>(column * geometry.stride_px) * bin_stride;
        for (std::size_t cell_u = 0; cell_u < cells; ++cell_u) {
          float* const histogram = block + (cell_u * cells + cell_v) * bins;
          if (bin_stride == kFewBins)
            add_columns<kFewBins>(of_row, weights[cell_u], bins, histogram);
          else
            add_columns<kManyBins>(of_row, weights[cell_u], bins, histogram);
        }
      }
      normalise(block, blocks.block_size);
    }
  }
  return blocks;
}

}  // namespace flies
