#include "flies/eval/footprint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace flies {
namespace {

constexpr double kExact = 1e-12;  // closed formulas in double

TEST(DistanceToFootprint, IsZeroInside) {
  const Footprint car{10.0, 2.0, 0.3, 4.0, 2.0};
  EXPECT_EQ(distance_to_footprint_m(car, 10.0, 2.0), 0.0);
  EXPECT_EQ(distance_to_footprint_m(car, 10.0 + 1.9 * std::cos(0.3), 2.0 + 1.9 * std::sin(0.3)), 0.0);
}

TEST(DistanceToFootprint, GrowsFromSidesAndCorners) {
  const Footprint car{10.0, 0.0, 0.0, 4.0, 2.0};
  EXPECT_NEAR(distance_to_footprint_m(car, 7.0, 0.5), 1.0, kExact);
  EXPECT_NEAR(distance_to_footprint_m(car, 10.0, -3.0), 2.0, kExact);
  EXPECT_NEAR(distance_to_footprint_m(car, 15.0, 5.0), 5.0, kExact);  // 3 before the corner, 4 beside it
}

TEST(DistanceToFootprint, TurnsWithYaw) {
  const Footprint across{10.0, 0.0, std::numbers::pi / 2, 4.0, 2.0};
  EXPECT_NEAR(distance_to_footprint_m(across, 8.0, 0.0), 1.0, kExact);
  EXPECT_NEAR(distance_to_footprint_m(across, 10.0, 2.0), 0.0, kExact);
}

TEST(NearFaceRange, MeetsTheFaceInTheDirectionAsked) {
  const Footprint car{10.0, 0.0, 0.0, 4.0, 2.0};
  ASSERT_TRUE(near_face_range_m(car, 0.0).has_value());
  EXPECT_NEAR(*near_face_range_m(car, 0.0), 8.0, kExact);
  EXPECT_NEAR(*near_face_range_m(car, 0.1), 8.0 / std::cos(0.1), kExact);
  EXPECT_FALSE(near_face_range_m(car, 0.2).has_value());  // 1.62 m beside the axis at its near end
  EXPECT_FALSE(near_face_range_m(car, std::numbers::pi).has_value());
}

TEST(NearFaceRange, IsZeroFromWithin) { EXPECT_EQ(near_face_range_m({0.0, 0.0, 0.5, 4.0, 2.0}, 1.0), 0.0); }

TEST(NearRange, IsThatOfTheNearestPoint) {
  EXPECT_NEAR(near_range_m({10.0, 5.0, 0.0, 4.0, 2.0}), std::hypot(8.0, 4.0), kExact);
}

TEST(SeenWidth, IsAcrossTheLineOfSight) {
  EXPECT_NEAR(seen_width_m({10.0, 0.0, 0.0, 4.0, 2.0}), 2.0, kExact);
  EXPECT_NEAR(seen_width_m({10.0, 0.0, std::numbers::pi / 2, 4.0, 2.0}), 4.0, kExact);
  EXPECT_NEAR(seen_width_m({0.0, 10.0, 0.0, 4.0, 2.0}), 4.0, kExact);
}

TEST(SeenDepth, IsOfTheFacesTurnedToUs) {
  EXPECT_NEAR(seen_depth_m({10.0, 0.0, 0.0, 4.0, 2.0}), 0.0, kExact);  // straight behind: only its back
  EXPECT_NEAR(seen_depth_m({0.0, 10.0, 0.0, 4.0, 2.0}), 0.0, kExact);  // straight beside
  // Turned by 45 degrees, back and side are seen, up to the ends of the diagonal.
  EXPECT_NEAR(seen_depth_m({10.0, 0.0, std::numbers::pi / 4, 4.0, 2.0}), 4.0 * std::sqrt(0.5), kExact);
  // Beside our way: from the near corner of its side, (8, 3), to the far one, (12, 3), along the line of sight.
  EXPECT_NEAR(seen_depth_m({10.0, 4.0, 0.0, 4.0, 2.0}), 4.0 * std::cos(std::atan2(4.0, 10.0)), kExact);
}

}  // namespace
}  // namespace flies
