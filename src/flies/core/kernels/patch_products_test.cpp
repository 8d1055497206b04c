#include "flies/core/kernels/patch_products.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>
#include <string>
#include <vector>

#include "flies/core/random.hpp"

namespace flies::kernels {
namespace {

constexpr std::size_t kWidth_px = 61;

class PatchProducts : public testing::TestWithParam<std::int64_t> {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  /// Levels of all kinds, or black and white alone, whose sums are the largest.
  static std::vector<std::int16_t> noise(std::uint32_t image, bool is_saturated) {
    std::vector<std::int16_t> pixels(kWidth_px * kProductRows);
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
      FlyRandom random(3, image, 0, i);
      pixels[i] = static_cast<std::int16_t>(is_saturated ? 255 * random.below(2) : random.below(256));
    }
    return pixels;
  }
};

TEST_P(PatchProducts, AreTheSumsOfTheirDefinition) {
  hwy::SetSupportedTargetsForTest(GetParam());
  constexpr int kPlaces = static_cast<int>(kWidth_px) - kProductColumns + 1, kColumn = 20;
  for (const bool is_saturated : {false, true}) {
    const auto one = noise(1, is_saturated), other = noise(2, is_saturated);
    std::vector<std::int32_t> product(kPlaces, -1);
    patch_products({.patch = one.data() + kColumn,
                    .others = other.data(),
                    .patch_stride = kWidth_px,
                    .others_stride = kWidth_px,
                    .places = kPlaces},
                   product.data());
    for (int place = 0; place < kPlaces; ++place) {
      std::int32_t sum = 0;
      for (std::size_t j = 0; j < kProductRows; ++j)
        for (std::size_t i = 0; i < kProductColumns; ++i)
          sum += one[j * kWidth_px + kColumn + i] * other[j * kWidth_px + static_cast<std::size_t>(place) + i];
      EXPECT_EQ(product[static_cast<std::size_t>(place)], sum) << "place " << place;
    }
  }
}

TEST(PatchProductsOfNothing, WriteNothing) {
  std::int32_t untouched = 7;
  patch_products({}, &untouched);
  EXPECT_EQ(untouched, 7);
}

INSTANTIATE_TEST_SUITE_P(AllTargets, PatchProducts, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

}  // namespace
}  // namespace flies::kernels
