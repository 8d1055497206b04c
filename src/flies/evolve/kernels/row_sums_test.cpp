#include "flies/evolve/kernels/row_sums.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <array>
#include <vector>

#include "flies/core/random.hpp"

namespace flies::kernels {
namespace {

TEST(SumRows, EqualsThePlainLoopsOnEveryTarget) {
  constexpr std::size_t kRows = 5, kRead = kRowColumns + 3;
  FlyRandom random(1, 0, 0, 0);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    for (int trial = 0; trial < 100; ++trial) {
      std::array<std::array<std::uint8_t, kRead>, kRows + 1> rows;
      // Every tenth trial saturates, where sums are largest; pixels behind the row differ, for they must not count.
      for (auto& row : rows)
        for (auto& pixel : row) pixel = trial % 10 == 0 ? 255 : static_cast<std::uint8_t>(random.below(256));
      std::array<const std::uint8_t*, kRows> right;
      for (std::size_t i = 0; i < kRows; ++i) right[i] = rows[i + 1].data();
      std::array<RowSums, kRows> fast, plain;
      sum_rows(rows[0].data(), right, fast.data());
      sum_rows_scalar(rows[0].data(), right, plain.data());
      EXPECT_EQ(fast, plain) << hwy::TargetName(target);
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(SumRowsScalar, AddsUpWhatTheRowsHold) {
  std::vector<std::uint8_t> left(kRowColumns + 3, 2), right(kRowColumns + 3, 3);
  const std::uint8_t* row = right.data();
  RowSums sums;
  sum_rows_scalar(left.data(), {&row, 1}, &sums);
  EXPECT_EQ(sums, (RowSums{kRowColumns * 3, kRowColumns * 9, kRowColumns * 6}));
}

}  // namespace
}  // namespace flies::kernels
