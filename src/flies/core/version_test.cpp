#include "flies/version.hpp"

#include <gtest/gtest.h>

#include <string>

namespace flies {
namespace {

TEST(Version, IsThatOfTheProject) {
  EXPECT_STREQ(FLIES_VERSION, FLIES_PROJECT_VERSION);
  EXPECT_EQ(library_version(), FLIES_PROJECT_VERSION);
  EXPECT_EQ(std::to_string(FLIES_VERSION_MAJOR) + '.' + std::to_string(FLIES_VERSION_MINOR) + '.' +
                std::to_string(FLIES_VERSION_PATCH),
            FLIES_PROJECT_VERSION);
}

}  // namespace
}  // namespace flies
