#include "flies/io/crc32.hpp"

#include <gtest/gtest.h>

namespace flies {
namespace {

TEST(Crc32, IsTheKnownOne) {
  EXPECT_EQ(crc32("123456789"), 0xCBF43926U);
  EXPECT_EQ(crc32("6789", crc32("12345")), 0xCBF43926U);
  EXPECT_EQ(crc32(""), 0U);
}

}  // namespace
}  // namespace flies
