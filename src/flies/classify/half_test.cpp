#include "flies/classify/half.hpp"

#include <gtest/gtest.h>
#include <opencv2/core/cvdef.h>

#include <cstring>
#include <limits>

#include "flies/core/random.hpp"

namespace flies {
namespace {

std::uint16_t opencvs_half(float value) {
  const cv::float16_t half(value);
  std::uint16_t bits = 0;
  std::memcpy(&bits, &half, sizeof(bits));
  return bits;
}

TEST(Half, EveryNumberIsRead) {
  for (std::uint32_t i = 0; i < 0x10000U; ++i) {
    const auto bits = static_cast<std::uint16_t>(i);
    const float value = from_half(bits), expected = static_cast<float>(cv::float16_t::fromBits(bits));
    if (std::isnan(expected)) {
      EXPECT_TRUE(std::isnan(value)) << i;
      continue;
    }
    ASSERT_EQ(value, expected) << i;
    ASSERT_EQ(half_of(value), bits) << i;
  }
}

TEST(Half, TheNearestNumberIsWritten) {
  FlyRandom random(1, 0, 0, 0);
  for (int i = 0; i < 200'000; ++i) {
    const auto value = static_cast<float>((random.uniform() - 0.5) * std::pow(2.0, 50.0 * random.uniform() - 30.0));
    ASSERT_EQ(half_of(value), opencvs_half(value)) << value;
  }
}

TEST(Half, TiesGoToTheEvenNumber) {
  for (std::uint16_t bits = 0; bits < 0x7BFF; ++bits) {
    const float middle = 0.5F * (from_half(bits) + from_half(static_cast<std::uint16_t>(bits + 1)));
    ASSERT_EQ(half_of(middle), bits % 2 == 0 ? bits : bits + 1) << middle;
    ASSERT_EQ(half_of(-middle), half_of(middle) | 0x8000) << middle;
  }
}

TEST(Half, TooLargeBecomesInfinite) {
  EXPECT_EQ(half_of(65519.0F), 0x7BFF);
  EXPECT_EQ(half_of(65520.0F), 0x7C00);
  EXPECT_EQ(half_of(-std::numeric_limits<float>::infinity()), 0xFC00);
  EXPECT_TRUE(std::isnan(from_half(half_of(std::nanf("")))));
}

}  // namespace
}  // namespace flies
