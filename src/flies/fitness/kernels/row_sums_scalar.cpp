#include "flies/fitness/kernels/row_sums.hpp"

namespace flies::kernels {
namespace {

template <bool kWithSquares>
void sum_rows(const PatchPair& patch, RowSums& sums) {
  const int next_column = patch.fraction16 != 0 ? 1 : 0;  // whole columns have no need of the one after the last
  sums.ll = sums.rr = 0;
  for (int j = 0; j < patch.rows; ++j) {
    const std::uint8_t* left = patch.left + j * patch.left_stride;
    const std::uint8_t* right = patch.right + j * patch.right_stride;
    // The largest, 25 columns of r * r, stays below 2^29.
    std::int32_t l_sum = 0, r_sum = 0, lr_sum = 0, ll_sum = 0, rr_sum = 0;
    for (int i = 0; i < patch.columns; ++i) {
      const std::int32_t l = left[i];
      const std::int32_t r = (kScale - patch.fraction16) * right[i] + patch.fraction16 * right[i + next_column];
      l_sum += l;
      r_sum += r;
      lr_sum += l * r;
      if constexpr (kWithSquares) {
        ll_sum += l * l;
        rr_sum += r * r;
      }
    }
    const auto row = static_cast<std::size_t>(j);
    sums.l[row] = l_sum;
    sums.r[row] = r_sum;
    sums.lr[row] = lr_sum;
    sums.ll += ll_sum;
    sums.rr += rr_sum;
  }
}

std::int64_t sum_squares_of_differences(const PatchPair& patch) {
  const int next_column = patch.fraction16 != 0 ? 1 : 0;
  std::int64_t sum = 0;
  for (int j = 0; j < patch.rows; ++j) {
    const std::uint8_t* left = patch.left + j * patch.left_stride;
    const std::uint8_t* right = patch.right + j * patch.right_stride;
    std::int32_t row = 0;
    for (int i = 0; i < patch.columns; ++i) {
      const std::int32_t difference =
          kScale * left[i] - (kScale - patch.fraction16) * right[i] - patch.fraction16 * right[i + next_column];
      row += difference * difference;
    }
    sum += row;
  }
  return sum;
}

}  // namespace

const RowSumsKernel& scalar_kernel() {
  static constexpr RowSumsKernel kernel = {"scalar", sum_rows<false>, sum_rows<true>, sum_squares_of_differences};
  return kernel;
}

}  // namespace flies::kernels
