#pragma once

#include <cstdint>

namespace flies::kernels {

/// Two neighbourhoods of equal size inside their images. The right one lies `fraction16`/16 px to the right of whole
/// columns; when that is not 0 the column after its last one is read too.
struct PatchPair {
  const std::uint8_t* left = nullptr;   ///< top-left pixel of the left neighbourhood
  const std::uint8_t* right = nullptr;  ///< top-left pixel of the right neighbourhood
  std::ptrdiff_t left_stride = 0;
  std::ptrdiff_t right_stride = 0;
  int columns = 0;     ///< odd, 3..25
  int rows = 0;        ///< odd, 3..33
  int fraction16 = 0;  ///< 0..15
};

/// Summed squared differences, in (1/16 grey level)^2: the denominator of Eq. (1) times 256.
std::int64_t sum_squared_differences(const PatchPair& patch);

/// Sum over the rows of covariance times exp(-|difference of row means|): Eq. (2). May be negative.
double sum_weighted_covariance(const PatchPair& patch);

/// Sums over all rows of the row-centred second moments, in squared grey levels.
struct RowCentredMoments {
  double covariance = 0.0;
  double left_variance = 0.0;
  double right_variance = 0.0;
};
RowCentredMoments sum_row_centred_moments(const PatchPair& patch);

}  // namespace flies::kernels
