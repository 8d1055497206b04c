#pragma once

#include <array>
#include <cstddef>

namespace flies::kernels {

/// Floats that may be read, and written, behind the end of a row: a vector of any instruction set.
constexpr std::size_t kRowPadding = 16;
/// Rows of pixels that are added up at once.
constexpr std::size_t kRowsAtOnce = 4;
/// Bins that stand side by side in interleaved sums.
constexpr std::size_t kBinsAside = 4;

/// The square root of each; `count` rounded up to `kRowPadding` of them.
void square_roots(float* values, std::size_t count);

/// A share of the magnitude of every pixel's gradient for the two orientations next to its own, linear in the angle.
/// @param rows    the row above, the row itself and the one below; the first pixel has a neighbour on its left
/// @param width   of the row; `width` rounded up to `kRowPadding`, and one more, are read
/// @param bins    orientations over 180 degrees
/// @param planes  for each orientation its shares, a plane of `plane_size` after the other
void vote_row(const std::array<const float*, 3>& rows, std::size_t width, int bins, std::size_t plane_size,
              float* planes);

/// sums[i] += weights[0] * rows[i] + weights[1] * rows[size + i] + ...
/// @param size a multiple of `kRowPadding`
void add_rows(const float* rows, const std::array<float, kRowsAtOnce>& weights, std::size_t size, float* sums);

/// Four planes, element by element: out[4 * i + k] = planes[k * plane_size + i].
void interleave(const float* planes, std::size_t plane_size, float* out);

/// Weighted sums of interleaved columns, one for every cell of a row: out[4 * c + k] = sum of
/// weights[4 * i + k] * columns[4 * (c * stride + i) + k]
/// @param weights of `count` columns, a multiple of four, each four times
void add_columns(const float* columns, const float* weights, std::size_t count, std::size_t stride, std::size_t cells,
                 float* out);

/// L2-Hys: unit length, no number above 0.2, unit length again. The small constants are those of `cv::HOGDescriptor`.
void normalise_block(float* block, std::size_t size);

}  // namespace flies::kernels
