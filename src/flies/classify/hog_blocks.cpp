#include "flies/classify/hog_blocks.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace flies {
namespace {

/// What every pixel votes for: a share of its gradient's magnitude for the orientation below its own, the rest for the
/// one above.
struct Votes {
  int width_px = 0;
  std::vector<std::uint16_t> lower, upper;  ///< orientation
  std::vector<float> for_lower, for_upper;

  explicit Votes(int width, int height)
      : width_px(width),
        lower(static_cast<std::size_t>(width * height)),
        upper(lower.size()),
        for_lower(lower.size()),
        for_upper(lower.size()) {}
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

Votes votes_of(const FloatImage& pixels, int bins) {
  const int width = pixels.width_px - 2 * kHogMargin_px, height = pixels.height_px - 2 * kHogMargin_px;
  Votes votes(width, height);
  std::vector<float> magnitude(static_cast<std::size_t>(width)), place(magnitude.size());
  for (int v = 0; v < height; ++v) {
    const float* const above = pixels.row(v) + 1;
    const float* const here = pixels.row(v + 1);
    const float* const below = pixels.row(v + 2) + 1;
    float* const m = magnitude.data();
    float* const p = place.data();
    for (int u = 0; u < width; ++u) {
      const float du = here[u + 2] - here[u], dv = below[u] - above[u];
      m[u] = std::sqrt(du * du + dv * dv);
      // Opposite gradients count as one: a light coat before a dark wall is a dark coat before a light wall.
      p[u] = half_turns(dv < 0.0F ? -du : du, std::abs(dv)) * static_cast<float>(bins) + 0.5F;
    }
    const auto row = static_cast<std::size_t>(v * width);
    for (int u = 0; u < width; ++u) {
      const auto above_bin = static_cast<int>(p[u]);  // 0 to bins: the bin whose centre lies above, of a ring
      const float share = p[u] - static_cast<float>(above_bin);
      const auto i = row + static_cast<std::size_t>(u);
      votes.upper[i] = static_cast<std::uint16_t>(above_bin == bins ? 0 : above_bin);
      votes.lower[i] = static_cast<std::uint16_t>(above_bin == 0 ? bins - 1 : above_bin - 1);
      votes.for_upper[i] = m[u] * share;
      votes.for_lower[i] = m[u] - m[u] * share;
    }
  }
  return votes;
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
  const auto length = [&] {
    float squares = 0.0F;
    for (std::size_t i = 0; i < size; ++i) squares += block[i] * block[i];
    return std::sqrt(squares);
  };
  const float first = 1.0F / (length() + 0.1F * static_cast<float>(size));
  for (std::size_t i = 0; i < size; ++i) block[i] = std::min(block[i] * first, kClip);
  const float second = 1.0F / (length() + 1e-3F);
  for (std::size_t i = 0; i < size; ++i) block[i] *= second;
}

/// One row of cells: the votes of its rows of pixels, weighted, for every column of pixels.
void sum_rows(const Votes& votes, int first_row, const std::vector<float>& weights, std::size_t bins,
              std::vector<float>& sums) {
  std::fill(sums.begin(), sums.end(), 0.0F);
  for (std::size_t j = 0; j < weights.size(); ++j) {
    const float weight = weights[j];
    if (weight == 0.0F) continue;
    const auto row = (static_cast<std::size_t>(first_row) + j) * static_cast<std::size_t>(votes.width_px);
    float* sum = sums.data();
    for (std::size_t i = row; i < row + static_cast<std::size_t>(votes.width_px); ++i, sum += bins) {
      sum[votes.lower[i]] += weight * votes.for_lower[i];
      sum[votes.upper[i]] += weight * votes.for_upper[i];
    }
  }
}

}  // namespace

HogBlocks hog_blocks(FloatImage pixels, const HogGeometry& geometry) {
  if (geometry.gamma)
    for (float& value : pixels.values) value = std::sqrt(value);
  const Votes votes = votes_of(pixels, geometry.bins);
  const auto weights = axis_weights(geometry);
  const auto bins = static_cast<std::size_t>(geometry.bins), cells = weights.size();
  const auto count = [&](int size_px) {
    assert(size_px >= geometry.block_px && (size_px - geometry.block_px) % geometry.stride_px == 0);
    return (size_px - geometry.block_px) / geometry.stride_px + 1;
  };
  HogBlocks blocks{count(votes.width_px), count(pixels.height_px - 2 * kHogMargin_px), cells * cells * bins, {}};
  blocks.values.resize(static_cast<std::size_t>(blocks.columns) * static_cast<std::size_t>(blocks.rows) *
                       blocks.block_size);

  std::vector<float> sums(static_cast<std::size_t>(votes.width_px) * bins);
  for (int row = 0; row < blocks.rows; ++row) {
    for (std::size_t cell_v = 0; cell_v < cells; ++cell_v) {
      sum_rows(votes, row * geometry.stride_px, weights[cell_v], bins, sums);
      for (int column = 0; column < blocks.columns; ++column) {
        float* const block = const_cast<float*>(blocks.block(column, row));
        for (std::size_t cell_u = 0; cell_u < cells; ++cell_u) {
          float* const histogram = block + (cell_u * cells + cell_v) * bins;
          const float* sum = sums.data() + static_cast<std::size_t>(column * geometry.stride_px) * bins;
          for (std::size_t i = 0; i < weights[cell_u].size(); ++i, sum += bins) {
            const float weight = weights[cell_u][i];
            if (weight == 0.0F) continue;
            for (std::size_t bin = 0; bin < bins; ++bin) histogram[bin] += weight * sum[bin];
          }
        }
      }
    }
    for (int column = 0; column < blocks.columns; ++column)
      normalise(const_cast<float*>(blocks.block(column, row)), blocks.block_size);
  }
  return blocks;
}

}  // namespace flies
