#include "flies/propose/propose.hpp"

#include <gtest/gtest.h>

namespace flies {
namespace {

TEST(ProposeRois, IsEmptyWithoutObstacles) {
  StereoCamera camera{700, 700, 600, 600, 180, 0.54, 1242, 375, {}};
  EXPECT_TRUE(propose_rois({}, Projection(camera), {}, 1242, 375, {}).empty());
}

}  // namespace
}  // namespace flies
