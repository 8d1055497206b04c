#include "flies/core/letters.hpp"

#include <gtest/gtest.h>

namespace flies::detail {
namespace {

TEST(InSmallLetters, KeepsSigns) {
  EXPECT_EQ(in_small_letters("Left_K-1 \xC3\x84"), "left_k-1 \xC3\x84");  // other alphabets stay as they are
  EXPECT_EQ(in_small_letters(""), "");
}

TEST(PlainLetters, LeaveSignsOut) {
  EXPECT_EQ(plain_letters("RS2_Distortion.Kannala-Brandt4:"), "rs2distortionkannalabrandt4");
  EXPECT_EQ(plain_letters("_ -"), "");
}

}  // namespace
}  // namespace flies::detail
