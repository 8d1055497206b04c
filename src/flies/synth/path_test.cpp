#include "flies/synth/path.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace flies::synth {
namespace {

TEST(Path, CoversTheAreaUnderItsSpeed) {
  const Path path{{{1, 2, 0}, std::numbers::pi_v<float> / 2}, {{1.0F, 4.0F}, {3.0F, 0.0F}}};
  EXPECT_FLOAT_EQ(path.travelled_m(1.0F), 4.0F);
  EXPECT_FLOAT_EQ(path.travelled_m(3.0F), 8.0F);
  EXPECT_FLOAT_EQ(path.travelled_m(10.0F), 8.0F);
  const Placement end = path.at(3.0F);
  EXPECT_NEAR(end.position.x, 1.0, 1e-5);
  EXPECT_NEAR(end.position.y, 10.0, 1e-5);
}

TEST(Path, StepsToTheSideAndFacesWhereItGoes) {
  const Path path{{}, {{0.0F, 5.0F}}, {1.0F, 3.0F, 3.0F}};
  EXPECT_NEAR(path.at(1.0F).position.y, 0.0, 1e-6);
  EXPECT_NEAR(path.at(3.5F).position.y, 3.0, 1e-6);
  EXPECT_NEAR(path.at(3.5F).yaw_rad, 0.0, 1e-6);
  EXPECT_GT(path.at(2.0F).yaw_rad, 0.3);
}

TEST(Path, VelocityIsTheChangeOfPlace) {
  const Path path{{{0, 0, 0}, 0.4F}, {{0.0F, 3.0F}, {2.0F, 8.0F}}, {0.5F, 2.5F, -2.0F}};
  for (const float t : {0.3F, 1.0F, 1.7F, 2.4F}) {
    const Vec3 change = (path.at(t + 0.01F).position - path.at(t - 0.01F).position) * 50.0F;
    const Vec3 velocity = path.velocity_at(t);
    EXPECT_NEAR(velocity.x, change.x, 0.02);
    EXPECT_NEAR(velocity.y, change.y, 0.02);
  }
}

TEST(Inverse, TakesAPlacementBackToTheOrigin) {
  const Placement place{{3, -2, 0}, 0.7F};
  const Placement back = inverse(place);
  const Mesh mesh = placed(placed(box({0, 0, 0}, {1, 1, 1}, {}), place), back);
  EXPECT_NEAR(bounds_of(mesh).low.x, 0.0, 1e-5);
  EXPECT_NEAR(bounds_of(mesh).high.y, 1.0, 1e-5);
}

}  // namespace
}  // namespace flies::synth
