#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <iterator>

#include "flies/fitness/kernels/kernel.hpp"
#include "flies/fitness/kernels/mean_agreement.hpp"

namespace flies::kernels {
namespace {

/// Sums over one row. The largest, 25 columns of r r, stays below 2^29.
struct RowSums {
  std::int32_t l = 0, r = 0, lr = 0, ll = 0, rr = 0, squared_differences = 0;
};

RowSums sum_row(const PatchImages& images, const PatchPlace& place, int j) {
  const std::uint8_t* left = place.left + j * images.left_stride;
  const std::uint8_t* right = place.right + j * images.right_stride;
  const int next_column = place.fraction16 != 0 ? 1 : 0;  // whole columns have no need of the one after the last
  RowSums sums;
  for (int i = 0; i < images.columns; ++i) {
    const std::int32_t l = left[i];
    const std::int32_t r = (kScale - place.fraction16) * right[i] + place.fraction16 * right[i + next_column];
    sums.l += l;
    sums.r += r;
    sums.lr += l * r;
    sums.ll += l * l;
    sums.rr += r * r;
    sums.squared_differences += (kScale * l - r) * (kScale * l - r);
  }
  return sums;
}

void sum_squared_differences(const PatchImages& images, std::span<const PatchPlace> places, std::int64_t* sums) {
  for (const PatchPlace& place : places) {
    std::int64_t sum = 0;
    for (int j = 0; j < images.rows; ++j) sum += sum_row(images, place, j).squared_differences;
    *sums++ = sum;
  }
}

float agreement(const MeanAgreement& of, std::int32_t difference) {
  const float y = std::min(static_cast<float>(difference) * of.step, MeanAgreement::kMaxExponent);
  const float t = y + MeanAgreement::kRounder;
  const float f = (t - MeanAgreement::kRounder) - y;
  float power = MeanAgreement::kPolynomial[0];
  for (std::size_t i = 1; i < std::size(MeanAgreement::kPolynomial); ++i)
    power = power * f + MeanAgreement::kPolynomial[i];
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(power) - (std::bit_cast<std::uint32_t>(t) << 23));
}

void sum_weighted_covariances(const PatchImages& images, std::span<const PatchPlace> places, float* sums) {
  const MeanAgreement of(images.columns);
  const int n = images.columns;
  for (const PatchPlace& place : places) {
    // As many sums as the vector kernels have, added up in their order.
    std::array<float, 8> part{};
    for (int j = 0; j < images.rows; ++j) {
      const auto row = sum_row(images, place, j);
      // Both products are below 25 * 25 * 255 * 4080, which 32 bits hold.
      const std::int32_t C = n * row.lr - row.l * row.r;
      part[static_cast<std::size_t>(j % 8)] += static_cast<float>(C) * agreement(of, std::abs(kScale * row.l - row.r));
    }
    for (std::size_t half : {4U, 2U, 1U})
      for (std::size_t i = 0; i < half; ++i) part[i] += part[i + half];
    *sums++ = part[0] / static_cast<float>(kScale * n);
  }
}

void sum_moments(const PatchImages& images, std::span<const PatchPlace> places, PatchMoments* moments) {
  const std::int64_t n = images.columns;
  for (const PatchPlace& place : places) {
    PatchMoments sum;
    for (int j = 0; j < images.rows; ++j) {
      const auto row = sum_row(images, place, j);
      const std::int64_t l = row.l, r = row.r;
      sum.lr += n * row.lr - l * r;
      sum.ll += n * row.ll - l * l;
      sum.rr += n * row.rr - r * r;
    }
    *moments++ = sum;
  }
}

}  // namespace

const Kernel& scalar_kernel() {
  static constexpr Kernel kKernel = {"scalar", sum_squared_differences, sum_weighted_covariances, sum_moments};
  return kKernel;
}

}  // namespace flies::kernels
