#include "flies/fitness/kernels/kernel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "flies/core/random.hpp"

namespace flies::kernels {
namespace {

struct Patch {
  PatchImages images;
  PatchPlace place;

  std::int64_t squared_differences(const Kernel& kernel) const {
    return evaluate<std::int64_t>(kernel.sum_squared_differences);
  }
  float weighted_covariance(const Kernel& kernel) const { return evaluate<float>(kernel.sum_weighted_covariances); }
  PatchMoments moments(const Kernel& kernel) const { return evaluate<PatchMoments>(kernel.sum_moments); }

 private:
  template <class Result, class Evaluate>
  Result evaluate(const Evaluate& evaluate) const {
    // Several times, as kernels may have a way of their own to read some patches at once.
    const std::vector<PatchPlace> places(5, place);
    std::vector<Result> results(places.size());
    evaluate(images, places, results.data());
    for (const Result& result : results) EXPECT_EQ(result, results[0]);
    return results[0];
  }
};

/// A pair of images on the heap that end with the last byte a patch in their bottom right corner may read, so that the
/// address sanitizer sees any read beyond it, or some bytes later. Rows follow each other without a gap.
struct ExactPair {
  std::unique_ptr<std::uint8_t[]> left, right;
  Patch patch;

  /// @param grey  called with (column, row) for the left, then for the right image
  template <class Grey>
  ExactPair(int columns, int rows, int fraction16, int columns_before, Grey&& grey, int bytes_behind = 0) {
    const int left_width = columns_before + columns;
    const int right_width = left_width + (fraction16 != 0 ? 1 : 0);
    left = fill(left_width, rows, bytes_behind, grey);
    right = fill(right_width, rows, bytes_behind, grey);
    patch = {{.left_end = left.get() + left_width * rows + bytes_behind,
              .right_end = right.get() + right_width * rows + bytes_behind,
              .left_stride = left_width,
              .right_stride = right_width,
              .columns = columns,
              .rows = rows},
             {.left = left.get() + columns_before, .right = right.get() + columns_before, .fraction16 = fraction16}};
  }

 private:
  template <class Grey>
  static std::unique_ptr<std::uint8_t[]> fill(int width, int rows, int bytes_behind, Grey&& grey) {
    const auto bytes = static_cast<std::size_t>(width * rows + bytes_behind);
    std::unique_ptr<std::uint8_t[]> image(new std::uint8_t[bytes]);
    std::fill_n(image.get(), bytes, std::uint8_t{200});
    for (int v = 0; v < rows; ++v)
      for (int u = 0; u < width; ++u) image[static_cast<std::size_t>(v * width + u)] = grey(u, v);
    return image;
  }
};

/// The functions straight from the pixels, in arithmetic that needs no thought about overflow.
struct Expected {
  std::int64_t squared_differences = 0;
  PatchMoments moments;
  double weighted_covariance = 0, sum_of_terms = 0;  ///< Eq. (2), and the same with absolute terms
  double sum_of_covariances = 0;                     ///< the same without weights

  explicit Expected(const Patch& patch) {
    const auto& [images, place] = patch;
    const std::int64_t n = images.columns;
    for (int j = 0; j < images.rows; ++j) {
      std::int64_t l_sum = 0, r_sum = 0, lr_sum = 0, ll_sum = 0, rr_sum = 0;
      for (int i = 0; i < images.columns; ++i) {
        const std::int64_t l = place.left[j * images.left_stride + i];
        const std::uint8_t* right = place.right + j * images.right_stride + i;
        const std::int64_t r =
            place.fraction16 == 0 ? 16 * right[0] : (16 - place.fraction16) * right[0] + place.fraction16 * right[1];
        l_sum += l;
        r_sum += r;
        lr_sum += l * r;
        ll_sum += l * l;
        rr_sum += r * r;
        squared_differences += (16 * l - r) * (16 * l - r);
      }
      const std::int64_t C = n * lr_sum - l_sum * r_sum;
      const double scale = 16.0 * static_cast<double>(n);
      const double term =
          static_cast<double>(C) / scale * std::exp(-std::abs(static_cast<double>(16 * l_sum - r_sum)) / scale);
      weighted_covariance += term;
      sum_of_terms += std::abs(term);
      sum_of_covariances += std::abs(static_cast<double>(C) / scale);
      moments.lr += C;
      moments.ll += n * ll_sum - l_sum * l_sum;
      moments.rr += n * rr_sum - r_sum * r_sum;
    }
  }
};

/// What kernel.hpp and mean_agreement.hpp promise of Eq. (2).
constexpr double kSinglePrecision = 4e-7;
constexpr double kAgreementPrecision = 2e-7, kSmallAgreementPrecision = 6e-6;
/// The largest covariance of a row times the power of 2 that stands for all smaller ones.
constexpr double kSmallestAgreement = 25 * 255 * 255 * 2.4e-38;

void expect_all_kernels_agree(const Patch& patch) {
  const Expected expected(patch);
  const float scalar_covariance = patch.weighted_covariance(scalar_kernel());
  EXPECT_NEAR(scalar_covariance, expected.weighted_covariance,
              kSinglePrecision * expected.sum_of_terms +
                  std::min(kAgreementPrecision * expected.sum_of_covariances,
                           kSmallAgreementPrecision * expected.sum_of_terms) +
                  patch.images.rows * kSmallestAgreement);
  for (const Kernel& kernel : supported_kernels()) {
    SCOPED_TRACE(std::string(kernel.target) + " on " + std::to_string(patch.images.columns) + " x " +
                 std::to_string(patch.images.rows) + " at fraction " + std::to_string(patch.place.fraction16));
    // Not nearly but exactly equal.
    ASSERT_EQ(patch.squared_differences(kernel), expected.squared_differences);
    ASSERT_EQ(patch.weighted_covariance(kernel), scalar_covariance);
    const auto moments = patch.moments(kernel);
    ASSERT_EQ(moments.lr, expected.moments.lr);
    ASSERT_EQ(moments.ll, expected.moments.ll);
    ASSERT_EQ(moments.rr, expected.moments.rr);
  }
}

/// Calls `check` with (columns, rows, fraction16) for all of them.
template <class Check>
void for_each_patch(Check&& check) {
  for (int columns = 3; columns <= kMaxColumns; columns += 2)
    for (int rows = 3; rows <= kMaxRows; rows += 2)
      for (int fraction16 = 0; fraction16 < kScale; ++fraction16) check(columns, rows, fraction16);
}

TEST(Kernels, IsTheSameForEveryInstructionSetOnNoise) {
  FlyRandom random(7, 0, 0, 0);
  const auto noise = [&](int, int) { return static_cast<std::uint8_t>(random.below(256)); };
  for_each_patch([&](int columns, int rows, int fraction16) {
    // 40 columns of image before the patch: all of its rows but the last are followed by more than a vector.
    for (const int columns_before : {0, 3, 40})
      for (const int bytes_behind : {0, 16})
        expect_all_kernels_agree(ExactPair(columns, rows, fraction16, columns_before, noise, bytes_behind).patch);
  });
}

TEST(Kernels, IsTheSameForEveryInstructionSetOnBrightImages) {
  const auto bright = [](int, int) { return std::uint8_t{255}; };
  for_each_patch([&](int columns, int rows, int fraction16) {
    for (const int bytes_behind : {0, 16})
      expect_all_kernels_agree(ExactPair(columns, rows, fraction16, 2, bright, bytes_behind).patch);
  });
}

TEST(Kernels, IsTheSameForEveryInstructionSetOnStripes) {
  const auto stripes = [](int u, int v) { return static_cast<std::uint8_t>((u + v / 2) % 2 == 0 ? 255 : 0); };
  for_each_patch([&](int columns, int rows, int fraction16) {
    for (const int bytes_behind : {0, 16})
      expect_all_kernels_agree(ExactPair(columns, rows, fraction16, 1, stripes, bytes_behind).patch);
  });
}

TEST(Kernels, IsTheSameForEveryInstructionSetWhereOneImageIsBlack) {
  for (const bool left_is_black : {false, true})
    for_each_patch([&](int columns, int rows, int fraction16) {
      for (const int bytes_behind : {0, 16}) {
        int calls = 0;
        const auto one_black = [&](int, int) {
          const bool in_left = calls++ < columns * rows;
          return static_cast<std::uint8_t>(in_left == left_is_black ? 0 : 255);
        };
        expect_all_kernels_agree(ExactPair(columns, rows, fraction16, 0, one_black, bytes_behind).patch);
      }
    });
}

TEST(Kernels, IgnoresPixelsOutsideThePatch) {
  FlyRandom random(8, 0, 0, 0);
  for (const int fraction16 : {0, 5}) {
    // A patch of 13 columns in the middle of rows of 60; then all pixels it must not use change.
    std::vector<std::uint8_t> left(60 * 19), right(60 * 19);
    for (auto* image : {&left, &right})
      for (auto& pixel : *image) pixel = static_cast<std::uint8_t>(random.below(256));
    const auto patch_of = [&](const std::vector<std::uint8_t>& l, const std::vector<std::uint8_t>& r) {
      return Patch{{l.data() + l.size(), r.data() + r.size(), 60, 60, 13, 19},
                   {l.data() + 20, r.data() + 20, fraction16}};
    };
    auto changed_left = left, changed_right = right;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const std::size_t u = i % 60;
      if (u < 20 || u >= 33) changed_left[i] = static_cast<std::uint8_t>(~left[i]);
      if (u < 20 || u >= (fraction16 == 0 ? 33U : 34U)) changed_right[i] = static_cast<std::uint8_t>(~right[i]);
    }
    const Patch patch = patch_of(left, right), changed = patch_of(changed_left, changed_right);
    for (const Kernel& kernel : supported_kernels()) {
      SCOPED_TRACE(kernel.target);
      EXPECT_EQ(changed.squared_differences(kernel), patch.squared_differences(kernel));
      EXPECT_EQ(changed.weighted_covariance(kernel), patch.weighted_covariance(kernel));
      EXPECT_EQ(changed.moments(kernel).rr, patch.moments(kernel).rr);
    }
  }
}

TEST(Kernels, EvaluateManyPlacesAsEachAlone) {
  // The buffers of a kernel must not carry anything over from one place to the next.
  FlyRandom random(9, 0, 0, 0);
  std::vector<std::uint8_t> image(64 * 48);
  for (auto& pixel : image) pixel = static_cast<std::uint8_t>(random.below(256));
  for (const int columns : {5, 13, 25})
    for (const int rows : {3, 19, 33}) {
      const PatchImages images = {image.data() + image.size(), image.data() + image.size(), 64, 64, columns, rows};
      std::vector<PatchPlace> places;
      const auto below = [&](int limit) {
        return static_cast<std::ptrdiff_t>(random.below(static_cast<unsigned>(limit)));
      };
      for (int i = 0; i < 20; ++i) {
        // Every other one at the bottom of the images.
        const std::ptrdiff_t row = (i % 2 == 0 ? 48 - rows : below(49 - rows)) * 64;
        places.push_back({image.data() + row + below(65 - columns), image.data() + row + below(64 - columns),
                          static_cast<std::int32_t>(below(16))});
      }
      for (const Kernel& kernel : supported_kernels()) {
        std::vector<float> covariances(places.size());
        std::vector<PatchMoments> moments(places.size());
        kernel.sum_weighted_covariances(images, places, covariances.data());
        kernel.sum_moments(images, places, moments.data());
        for (std::size_t i = 0; i < places.size(); ++i) {
          const Patch alone = {images, places[i]};
          ASSERT_EQ(covariances[i], alone.weighted_covariance(scalar_kernel())) << kernel.target;
          ASSERT_EQ(moments[i].rr, alone.moments(scalar_kernel()).rr) << kernel.target;
        }
      }
    }
}

TEST(SelectKernel, FindsEveryKernelByItsNameInEitherCase) {
  for (const Kernel& kernel : supported_kernels()) {
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
