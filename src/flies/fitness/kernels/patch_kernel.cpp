#include "flies/fitness/kernels/patch_kernel.hpp"

#include <array>
#include <cmath>
#include <cstddef>

// Everything here is exact integer arithmetic up to the last multiplication of a row: grey levels are bytes, the
// right neighbourhood is kept in sixteenths of a grey level (12 bits), and the largest sum (25 columns of squares)
// stays below 2^29. Exactness is what makes results independent of the order of summation, hence of the instruction
// set.
namespace flies::kernels {
namespace {

constexpr int kScale = 16;  ///< sub-pixel steps, also the scale of the right neighbourhood's grey levels

/// A row of the patch: sums of l, r, l*r, l*l, r*r with r in sixteenths.
struct RowSums {
  std::int32_t l = 0, r = 0, lr = 0, ll = 0, rr = 0;
};

template <bool kWithSquares>
RowSums sum_row(const std::uint8_t* left, const std::uint8_t* right, int columns, int fraction16) {
  RowSums sums;
  for (int i = 0; i < columns; ++i) {
    const std::int32_t l = left[i];
    const std::int32_t r = (kScale - fraction16) * right[i] + fraction16 * right[i + 1];
    sums.l += l;
    sums.r += r;
    sums.lr += l * r;
    if constexpr (kWithSquares) {
      sums.ll += l * l;
      sums.rr += r * r;
    }
  }
  return sums;
}

/// D of Eq. (2), exp(-|difference of the row means|), from the difference of 16 times the sums.
double mean_agreement(std::int64_t difference, int columns) {
  return std::exp(-static_cast<double>(difference) / (kScale * columns));
}

}  // namespace

std::int64_t sum_squared_differences(const PatchPair& patch) {
  std::int64_t sum = 0;
  for (int j = 0; j < patch.rows; ++j) {
    const std::uint8_t* left = patch.left + j * patch.left_stride;
    const std::uint8_t* right = patch.right + j * patch.right_stride;
    std::int32_t row = 0;
    for (int i = 0; i < patch.columns; ++i) {
      const std::int32_t difference =
          kScale * left[i] - (kScale - patch.fraction16) * right[i] - patch.fraction16 * right[i + 1];
      row += difference * difference;
    }
    sum += row;
  }
  return sum;
}

double sum_weighted_covariance(const PatchPair& patch) {
  const int n = patch.columns;
  double sum = 0.0;
  for (int j = 0; j < patch.rows; ++j) {
    const auto row =
        sum_row<false>(patch.left + j * patch.left_stride, patch.right + j * patch.right_stride, n, patch.fraction16);
    const std::int64_t covariance = static_cast<std::int64_t>(n) * row.lr - static_cast<std::int64_t>(row.l) * row.r;
    const std::int64_t mean_difference = std::abs(static_cast<std::int64_t>(kScale) * row.l - row.r);
    sum += static_cast<double>(covariance) * mean_agreement(mean_difference, n);
  }
  return sum / (kScale * n);
}

RowCentredMoments sum_row_centred_moments(const PatchPair& patch) {
  const int n = patch.columns;
  std::int64_t covariance = 0, left_variance = 0, right_variance = 0;
  for (int j = 0; j < patch.rows; ++j) {
    const auto row =
        sum_row<true>(patch.left + j * patch.left_stride, patch.right + j * patch.right_stride, n, patch.fraction16);
    const std::int64_t l = row.l, r = row.r;
    covariance += n * static_cast<std::int64_t>(row.lr) - l * r;
    left_variance += n * static_cast<std::int64_t>(row.ll) - l * l;
    right_variance += n * static_cast<std::int64_t>(row.rr) - r * r;
  }
  return {static_cast<double>(covariance) / (kScale * n), static_cast<double>(left_variance) / n,
          static_cast<double>(right_variance) / (kScale * kScale * n)};
}

}  // namespace flies::kernels
