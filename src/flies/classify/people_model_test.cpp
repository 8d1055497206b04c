#include "flies/classify/people_model.hpp"

#include <gtest/gtest.h>

namespace flies {
namespace {

TEST(BuiltinPeopleModel, IsConsistent) { EXPECT_NO_THROW(check_people_model(builtin_people_model(), "built-in")); }

}  // namespace
}  // namespace flies
