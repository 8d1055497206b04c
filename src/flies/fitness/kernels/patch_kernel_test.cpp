#include "flies/fitness/kernels/patch_kernel.hpp"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "flies/core/random.hpp"
#include "flies/fitness/kernels/row_sums.hpp"

namespace flies::kernels {
namespace {

/// A pair of images on the heap that end with the last byte a patch in their bottom right corner may read, so that the
/// address sanitizer sees any read beyond it. Rows follow each other without a gap.
struct ExactPair {
  std::unique_ptr<std::uint8_t[]> left, right;
  PatchPair patch;

  /// @param grey  called with (column, row) for the left, then for the right image
  template <class Grey>
  ExactPair(int columns, int rows, int fraction16, int columns_before, Grey&& grey) {
    const int left_width = columns_before + columns;
    const int right_width = left_width + (fraction16 != 0 ? 1 : 0);
    left = fill(left_width, rows, grey);
    right = fill(right_width, rows, grey);
    patch = {.left = left.get() + columns_before,
             .right = right.get() + columns_before,
             .left_stride = left_width,
             .right_stride = right_width,
             .columns = columns,
             .rows = rows,
             .fraction16 = fraction16};
  }

 private:
  template <class Grey>
  static std::unique_ptr<std::uint8_t[]> fill(int width, int rows, Grey&& grey) {
    std::unique_ptr<std::uint8_t[]> image(new std::uint8_t[static_cast<std::size_t>(width * rows)]);
    for (int v = 0; v < rows; ++v)
      for (int u = 0; u < width; ++u) image[static_cast<std::size_t>(v * width + u)] = grey(u, v);
    return image;
  }
};

/// The functions straight from the pixels, in arithmetic that needs no thought about overflow.
struct Expected {
  std::int64_t squared_differences = 0;
  long double weighted_covariance = 0;
  std::int64_t covariance = 0, left_variance = 0, right_variance = 0;  ///< times columns, and 16 for each r

  explicit Expected(const PatchPair& patch) {
    const std::int64_t n = patch.columns;
    for (int j = 0; j < patch.rows; ++j) {
      std::int64_t l_sum = 0, r_sum = 0, lr_sum = 0, ll_sum = 0, rr_sum = 0;
      for (int i = 0; i < patch.columns; ++i) {
        const std::int64_t l = patch.left[j * patch.left_stride + i];
        const std::uint8_t* right = patch.right + j * patch.right_stride + i;
        const std::int64_t r =
            patch.fraction16 == 0 ? 16 * right[0] : (16 - patch.fraction16) * right[0] + patch.fraction16 * right[1];
        l_sum += l;
        r_sum += r;
        lr_sum += l * r;
        ll_sum += l * l;
        rr_sum += r * r;
        squared_differences += (16 * l - r) * (16 * l - r);
      }
      const std::int64_t C = n * lr_sum - l_sum * r_sum;
      weighted_covariance +=
          static_cast<long double>(C) / static_cast<long double>(16 * n) *
          std::exp(-std::abs(static_cast<long double>(16 * l_sum - r_sum)) / static_cast<long double>(16 * n));
      covariance += C;
      left_variance += n * ll_sum - l_sum * l_sum;
      right_variance += n * rr_sum - r_sum * r_sum;
    }
  }
};

/// Double precision: two table entries, their product, the sum over 33 rows whose signs may differ.
constexpr double kDoubleRounding = 1e-13;

void expect_all_kernels_agree(const PatchPair& patch) {
  const Expected expected(patch);
  const double n = patch.columns;
  const double scalar_covariance = sum_weighted_covariance(patch, scalar_kernel());
  EXPECT_NEAR(scalar_covariance, static_cast<double>(expected.weighted_covariance),
              kDoubleRounding * (1.0 + 255.0 * 255.0 * n * patch.rows));
  for (const RowSumsKernel& kernel : supported_kernels()) {
    SCOPED_TRACE(std::string(kernel.target) + " on " + std::to_string(patch.columns) + " x " +
                 std::to_string(patch.rows) + " at fraction " + std::to_string(patch.fraction16));
    ASSERT_EQ(sum_squared_differences(patch, kernel), expected.squared_differences);
    // Not nearly but exactly equal, from here on.
    ASSERT_EQ(sum_weighted_covariance(patch, kernel), scalar_covariance);
    const auto moments = sum_row_centred_moments(patch, kernel);
    ASSERT_EQ(moments.covariance, static_cast<double>(expected.covariance) / (16.0 * n));
    ASSERT_EQ(moments.left_variance, static_cast<double>(expected.left_variance) / n);
    ASSERT_EQ(moments.right_variance, static_cast<double>(expected.right_variance) / (256.0 * n));
  }
}

/// Calls `check` with (columns, rows, fraction16) for all of them.
template <class Check>
void for_each_patch(Check&& check) {
  for (int columns = 3; columns <= kMaxColumns; columns += 2)
    for (int rows = 3; rows <= kMaxRows; rows += 2)
      for (int fraction16 = 0; fraction16 < kScale; ++fraction16) check(columns, rows, fraction16);
}

TEST(PatchKernel, IsTheSameForEveryInstructionSetOnNoise) {
  FlyRandom random(7, 0, 0, 0);
  const auto noise = [&](int, int) { return static_cast<std::uint8_t>(random.below(256)); };
  for_each_patch([&](int columns, int rows, int fraction16) {
    // 40 columns of image before the patch: all of its rows but the last are followed by more than a vector.
    for (const int columns_before : {0, 3, 40})
      expect_all_kernels_agree(ExactPair(columns, rows, fraction16, columns_before, noise).patch);
  });
}

TEST(PatchKernel, IsTheSameForEveryInstructionSetOnBrightImages) {
  const auto bright = [](int, int) { return std::uint8_t{255}; };
  for_each_patch([&](int columns, int rows, int fraction16) {
    expect_all_kernels_agree(ExactPair(columns, rows, fraction16, 2, bright).patch);
  });
}

TEST(PatchKernel, IsTheSameForEveryInstructionSetOnStripes) {
  const auto stripes = [](int u, int v) { return static_cast<std::uint8_t>((u + v / 2) % 2 == 0 ? 255 : 0); };
  for_each_patch([&](int columns, int rows, int fraction16) {
    expect_all_kernels_agree(ExactPair(columns, rows, fraction16, 1, stripes).patch);
  });
}

TEST(PatchKernel, IsTheSameForEveryInstructionSetWhereOneImageIsBlack) {
  for (const bool left_is_black : {false, true})
    for_each_patch([&](int columns, int rows, int fraction16) {
      int calls = 0;
      const auto one_black = [&](int, int) {
        const bool in_left = calls++ < columns * rows;
        return static_cast<std::uint8_t>(in_left == left_is_black ? 0 : 255);
      };
      expect_all_kernels_agree(ExactPair(columns, rows, fraction16, 0, one_black).patch);
    });
}

TEST(PatchKernel, IgnoresPixelsOutsideThePatch) {
  FlyRandom random(8, 0, 0, 0);
  for (const int fraction16 : {0, 5}) {
    // A patch of 13 columns in the middle of rows of 60; then all pixels it must not use change.
    std::vector<std::uint8_t> left(60 * 19), right(60 * 19);
    for (auto* image : {&left, &right})
      for (auto& pixel : *image) pixel = static_cast<std::uint8_t>(random.below(256));
    const PatchPair patch = {left.data() + 20, right.data() + 20, 60, 60, 13, 19, fraction16};
    for (const RowSumsKernel& kernel : supported_kernels()) {
      const double before = sum_weighted_covariance(patch, kernel);
      auto changed_left = left, changed_right = right;
      for (std::size_t i = 0; i < left.size(); ++i) {
        const std::size_t u = i % 60;
        if (u < 20 || u >= 33) changed_left[i] = static_cast<std::uint8_t>(~left[i]);
        if (u < 20 || u >= (fraction16 == 0 ? 33U : 34U)) changed_right[i] = static_cast<std::uint8_t>(~right[i]);
      }
      auto changed = patch;
      changed.left = changed_left.data() + 20;
      changed.right = changed_right.data() + 20;
      EXPECT_EQ(sum_weighted_covariance(changed, kernel), before) << kernel.target;
    }
  }
}

TEST(SelectKernel, FindsEveryKernelByItsNameInEitherCase) {
  for (const RowSumsKernel& kernel : supported_kernels()) {
    std::string name(kernel.target);
    EXPECT_EQ(select_kernel(name).target, kernel.target);
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    EXPECT_EQ(select_kernel(name).target, kernel.target);
  }
}

TEST(SelectKernel, TakesTheFastestForOtherNames) {
  for (const char* name : {"", "MMX", "AVX", "AVX2 "})
    EXPECT_EQ(&select_kernel(name), &supported_kernels().front()) << name;
}

TEST(SupportedKernels, EndWithTheScalarOne) { EXPECT_EQ(supported_kernels().back().target, "scalar"); }

TEST(SupportedKernels, StartWithAVectorKernelOnCommonCpus) {
#if defined(__x86_64__) || defined(__aarch64__)
  EXPECT_NE(supported_kernels().front().target, "scalar");
#else
  GTEST_SKIP() << "not known to have vectors";
#endif
}

}  // namespace
}  // namespace flies::kernels
