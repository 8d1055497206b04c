#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flies::kernels {

/// What every output pixel is made of along one axis: `count` source pixels each, with their weights.
struct Taps {
  std::size_t count = 0;
  std::vector<int> source;     ///< `count` per output pixel
  std::vector<float> weights;  ///< likewise
};

/// Rows that are resized at once, side by side.
constexpr std::size_t kMixedRows = 4;
/// Columns of the longest vectors.
constexpr std::size_t kMixedColumns = 16;

/// Weighted sums of rows of grey levels, four at once.
/// @param rows    `taps` source rows for the first sum, as many for the next, and so on; `columns` pixels each
/// @param mixed   four numbers per column: column c of the r-th sum is mixed[4 * c + r]
void mix_rows(const std::uint8_t* const* rows, const float* weights, std::size_t taps, std::size_t columns,
              float* mixed);

/// Weighted sums of columns of what `mix_rows` writes.
/// @param width pixels that each of the four rows gets
/// @param aside room for four times as many
void mix_columns(const float* mixed, const Taps& taps, std::size_t width, float* aside,
                 const std::array<float*, kMixedRows>& rows);

}  // namespace flies::kernels
