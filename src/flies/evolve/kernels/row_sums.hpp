#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace flies::kernels {

/// Columns of a row that is compared; the width of the default patch.
constexpr int kRowColumns = 13;

/// Sums over the columns of two rows, one of the left and one of the right image. Exact.
struct RowSums {
  std::int32_t right = 0;     ///< of the right row's grey levels
  std::int32_t squares = 0;   ///< of their squares
  std::int32_t products = 0;  ///< of the products of both rows

  bool operator==(const RowSums&) const = default;
};

/// Compares a row with others. Each points to `kRowColumns` pixels; three more behind them are read.
void sum_rows(const std::uint8_t* left, std::span<const std::uint8_t* const> right, RowSums* sums);

/// The same in plain loops: the yardstick, and what runs where there are no vectors.
void sum_rows_scalar(const std::uint8_t* left, std::span<const std::uint8_t* const> right, RowSums* sums);

}  // namespace flies::kernels
