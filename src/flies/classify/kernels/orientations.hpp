#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace flies::kernels {

/// Floats that may be read, and written, behind the end of a row: a vector of any instruction set.
constexpr std::size_t kRowPadding = 16;
/// Rows of pixels that are added up at once.
constexpr std::size_t kRowsAtOnce = 4;
/// Bins that stand side by side in interleaved sums.
constexpr std::size_t kBinsAside = 4;

/// The square root of each; `count` rounded up to `kRowPadding` of them.
void square_roots(float* values, std::size_t count);

/// A row of cells that pixels add to.
struct CellRow {
  float* sums = nullptr;                     ///< for each orientation a plane, column by column
  std::array<float, kRowsAtOnce> weights{};  ///< of each row of pixels
};

/// Adds, weighted, a share of the magnitude of every pixel's gradient to the two orientations next to its own, linear
/// in the angle.
/// @param rows    those that vote, the row above them and the one below; the first pixel has a neighbour on its left
/// @param width   of the rows; `width` rounded up to `kRowPadding`, and one more, are read
/// @param bins    orientations over 180 degrees, 2 or more
/// @param plane_size from a plane to the next, at least `width` rounded up to `kRowPadding`
void add_votes(const std::array<const float*, kRowsAtOnce + 2>& rows, std::size_t width, int bins,
               std::size_t plane_size, std::span<const CellRow> cells);

/// Four planes, element by element: out[4 * i + k] = planes[k * plane_size + i].
void interleave(const float* planes, std::size_t plane_size, float* out);

/// Weighted sums of interleaved columns, one for every cell of a row: out[out_stride * c + k] = sum of
/// weights[4 * i + k] * columns[4 * (c * stride + i) + k]
/// @param weights of `count` columns, a multiple of four, each four times
/// @param bins    of the four, those that are written
void add_columns(const float* columns, const float* weights, std::size_t count, std::size_t stride, std::size_t cells,
                 std::size_t bins, std::size_t out_stride, float* out);

/// L2-Hys: unit length, no number above 0.2, unit length again. The small constants are those of `cv::HOGDescriptor`.
void normalise_block(float* block, std::size_t size);

}  // namespace flies::kernels
