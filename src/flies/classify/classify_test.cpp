#include "flies/classify/classify.hpp"

#include <gtest/gtest.h>

namespace flies {
namespace {

TEST(SuppressInMetres, IsEmptyWithoutRois) {
  EXPECT_TRUE(suppress_in_metres({}, {}, builtin_people_model(), {}).empty());
}

}  // namespace
}  // namespace flies
