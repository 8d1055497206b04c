#include "flies/fitness/kernels/patch_kernel.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include "flies/fitness/kernels/row_sums.hpp"

// Everything before the last multiplication of a row is exact integer arithmetic: grey levels are bytes, the right
// neighbourhood is kept in sixteenths of a grey level (12 bits). Exactness is what makes results independent of the
// order of summation, hence of the instruction set. What follows in floating point is compiled here, once, without the
// instruction sets of the kernels: fused multiplications there would round differently.
namespace flies::kernels {
namespace {

/// D of Eq. (2), exp(-|difference of the row means|), from the difference d of 16 times the sums of a row: a product of
/// two exponentials looked up by the upper and the lower bits of d, equal to exp(-d / (16 columns)) to 4 roundings.
class MeanAgreement {
 public:
  explicit MeanAgreement(int columns) {
    for (std::size_t i = 0; i < lower_.size(); ++i) lower_[i] = agreement(i, columns);
    for (std::size_t i = 0; i < upper_.size(); ++i) upper_[i] = agreement(i << kLowerBits, columns);
  }
  double operator()(std::uint32_t difference) const {
    return upper_[difference >> kLowerBits] * lower_[difference & (lower_.size() - 1)];
  }

 private:
  static constexpr int kLowerBits = 8;
  static constexpr std::size_t kMaxDifference = std::size_t{255} * kScale * kMaxColumns;

  static double agreement(std::size_t difference, int columns) {
    return std::exp(-static_cast<double>(difference) / (kScale * columns));
  }

  std::array<double, 1 << kLowerBits> lower_;
  std::array<double, (kMaxDifference >> kLowerBits) + 1> upper_;
};

const MeanAgreement& mean_agreement(int columns) {
  static const auto tables = [] {
    std::vector<MeanAgreement> all;
    for (int n = 1; n <= kMaxColumns; n += 2) all.emplace_back(n);
    return all;
  }();
  return tables[static_cast<std::size_t>(columns / 2)];
}

}  // namespace

std::int64_t sum_squared_differences(const PatchPair& patch, const RowSumsKernel& kernel) {
  return kernel.sum_squared_differences(patch);
}

double sum_weighted_covariance(const PatchPair& patch, const RowSumsKernel& kernel) {
  RowSums rows;
  kernel.sum_rows(patch, rows);
  const int n = patch.columns;
  const MeanAgreement& D = mean_agreement(n);
  double sum = 0.0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(patch.rows); ++j) {
    // Both products are below 25 * 25 * 255 * 4080, which 32 bits hold.
    const std::int32_t C = n * rows.lr[j] - rows.l[j] * rows.r[j];
    sum += C * D(static_cast<std::uint32_t>(std::abs(kScale * rows.l[j] - rows.r[j])));
  }
  return sum / (kScale * n);
}

RowCentredMoments sum_row_centred_moments(const PatchPair& patch, const RowSumsKernel& kernel) {
  RowSums rows;
  kernel.sum_rows_and_squares(patch, rows);
  const std::int64_t n = patch.columns;
  std::int64_t covariance = 0, left_squares = 0, right_squares = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(patch.rows); ++j) {
    const std::int64_t l = rows.l[j], r = rows.r[j];
    covariance += n * rows.lr[j] - l * r;
    left_squares += l * l;
    right_squares += r * r;
  }
  const auto scaled = [n](std::int64_t sum, int scale) {
    return static_cast<double>(sum) / static_cast<double>(scale * n);
  };
  return {scaled(covariance, kScale), scaled(n * rows.ll - left_squares, 1),
          scaled(n * rows.rr - right_squares, kScale * kScale)};
}

std::int64_t sum_squared_differences(const PatchPair& patch) { return sum_squared_differences(patch, chosen_kernel()); }
double sum_weighted_covariance(const PatchPair& patch) { return sum_weighted_covariance(patch, chosen_kernel()); }
RowCentredMoments sum_row_centred_moments(const PatchPair& patch) {
  return sum_row_centred_moments(patch, chosen_kernel());
}

}  // namespace flies::kernels
