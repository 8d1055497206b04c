#include "flies/core/usable_pair.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "flies/core/error.hpp"

namespace flies::detail {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth_px = 3, kHeight_px = 2;
constexpr std::array<std::uint8_t, 8> kPixels = {1, 2, 3, 4, 5, 6, 7, 8};

TEST(UsablePair, PacksViewsWithoutAStride) {
  const GrayView packed{kPixels.data(), kWidth_px, kHeight_px}, padded{kPixels.data(), kWidth_px, kHeight_px, 4};
  const auto pair = usable_pair({packed, padded});
  EXPECT_EQ(pair.left.at(0, 1), 4);
  EXPECT_EQ(pair.right.at(0, 1), 5);
}

TEST(UsablePair, RefusesRowsThatOverlap) {
  const GrayView packed{kPixels.data(), kWidth_px, kHeight_px};
  for (const std::ptrdiff_t stride : {2, -3}) {
    const GrayView overlapping{kPixels.data(), kWidth_px, kHeight_px, stride};
    EXPECT_THAT(
        [&] {
          usable_pair({packed, overlapping});
        },
        ThrowsMessage<InputError>(HasSubstr("right image: stride: found")));
  }
  EXPECT_THAT([] { usable_pair({}); }, ThrowsMessage<InputError>(HasSubstr("left image")));
}

TEST(IsOneImageTwice, LooksAtPixelsAlone) {
  const GrayView first{kPixels.data(), kWidth_px, kHeight_px, 4};
  const std::array<std::uint8_t, 6> same = {1, 2, 3, 5, 6, 7}, other = {1, 2, 3, 5, 6, 8};
  EXPECT_TRUE(is_one_image_twice({first, {same.data(), kWidth_px, kHeight_px, kWidth_px}}));
  const std::array<std::uint8_t, 6> black = {};
  const GrayView dark{black.data(), kWidth_px, kHeight_px, kWidth_px};
  EXPECT_FALSE(is_one_image_twice({dark, dark}));
  EXPECT_FALSE(is_one_image_twice({first, {other.data(), kWidth_px, kHeight_px, kWidth_px}}));
}

}  // namespace
}  // namespace flies::detail
