#include "flies/road/ground_plane.hpp"

#include <gtest/gtest.h>

#include "flies/core/random.hpp"

namespace flies {
namespace {

constexpr double kScale_px_m = 380.0;

/// Half of the places on the ground with a tenth of a pixel of noise, half anywhere above it.
SeenPlaces places_above(const CameraMount& mount) {
  const GroundPlane plane = plane_below(mount, kScale_px_m);
  SeenPlaces seen{700.0, kScale_px_m, {}};
  FlyRandom random(5, 0, 0, 0);
  while (seen.places.size() < 1000) {
    SeenPlace place{random.uniform(-0.8, 0.8), random.uniform(-0.3, 0.3), 0.0};
    const double on_ground_px = std::max(0.0, plane.parallax_px(place));
    const bool is_ground = on_ground_px > 2.0 && random.uniform() < 0.5;
    place.parallax_px = is_ground ? on_ground_px + 0.1 * random.normal() : on_ground_px + random.uniform(1.0, 60.0);
    seen.places.push_back(place);
  }
  return seen;
}

class FitGround : public testing::TestWithParam<CameraMount> {};

TEST_P(FitGround, FindsTheMount) {
  const CameraMount truth = GetParam();
  const SeenPlaces seen = places_above(truth);
  const auto found = fit_ground(seen, {});
  ASSERT_TRUE(found);
  const CameraMount mount = mount_above(found->plane, kScale_px_m);
  const MountDeviation deviation = mount_deviation(seen, found->plane);
  constexpr double kDeviations = 5.0;  // what noise may do
  EXPECT_NEAR(mount.height_m / truth.height_m, 1.0, kDeviations * deviation.height_share);
  EXPECT_NEAR(mount.pitch_rad, truth.pitch_rad, kDeviations * deviation.pitch_rad);
  EXPECT_NEAR(mount.roll_rad, truth.roll_rad, kDeviations * deviation.roll_rad);
  EXPECT_LT(deviation.height_share, 0.02);
  EXPECT_LT(deviation.pitch_rad, radians(0.3));
  EXPECT_LT(deviation.roll_rad, radians(0.3));
}

INSTANTIATE_TEST_SUITE_P(Mounts, FitGround,
                         testing::Values(CameraMount{}, CameraMount{0.4, radians(10), 0.0},
                                         CameraMount{3.0, radians(25), 0.0}, CameraMount{1.0, radians(-8), 0.0},
                                         CameraMount{1.2, radians(5), radians(10)},
                                         CameraMount{1.2, radians(5), radians(-10)}));

TEST(FitGround, TakesNoFloorAndWallForOnePlaneWhereBothAreWithinAFewDisparities) {
  const CameraMount truth{1.48, radians(4.0), 0.0};
  constexpr double kSmallScale_px_m = 16.0, kWallParallax_px = kSmallScale_px_m / 5.0;
  const GroundPlane floor = plane_below(truth, kSmallScale_px_m);
  SeenPlaces seen{250.0, kSmallScale_px_m, {}};
  FlyRandom random(6, 0, 0, 0);
  for (int i = 0; i < 600; ++i) {
    SeenPlace place{random.uniform(-0.9, 0.9), random.uniform(-0.45, 0.45), 0.0};
    place.parallax_px = std::max(kWallParallax_px, floor.parallax_px(place)) + 0.1 * random.normal();
    seen.places.push_back(place);
  }
  const auto found = fit_ground(seen, {});
  ASSERT_TRUE(found);
  const CameraMount mount = mount_above(found->plane, kSmallScale_px_m);
  EXPECT_NEAR(mount.height_m, truth.height_m, 0.1);
  EXPECT_NEAR(mount.pitch_rad, truth.pitch_rad, radians(2.0));
}

TEST(MountDeviation, IsNoLessForManyPlacesThanWhatTheyAreOffByTogether) {
  const auto pitch_deg = [](double scale_px_m) {
    const GroundPlane plane = plane_below({1.5, 0.0, 0.0}, scale_px_m);
    SeenPlaces seen{500.0, scale_px_m, {}};
    FlyRandom random(7, 0, 0, 0);
    for (int i = 0; i < 10'000; ++i) {
      SeenPlace place{random.uniform(-0.8, 0.8), random.uniform(0.25, 0.5), 0.0};
      place.parallax_px = plane.parallax_px(place) + 0.2 * random.normal();
      seen.places.push_back(place);
    }
    return degrees(mount_deviation(seen, plane).pitch_rad);
  };
  EXPECT_GT(pitch_deg(16.0), 1.0);   // a baseline of 0.06 m and few columns
  EXPECT_LT(pitch_deg(380.0), 0.2);  // a car
}

TEST(MountAbove, IsTheInverseOfPlaneBelow) {
  for (const double pitch_deg : {-15.0, 0.0, 25.0})
    for (const double roll_deg : {-10.0, 0.0, 4.0}) {
      const CameraMount mount{0.7, radians(pitch_deg), radians(roll_deg)};
      const CameraMount back = mount_above(plane_below(mount, kScale_px_m), kScale_px_m);
      EXPECT_NEAR(back.height_m, mount.height_m, 1e-9);
      EXPECT_NEAR(back.pitch_rad, mount.pitch_rad, 1e-9);
      EXPECT_NEAR(back.roll_rad, mount.roll_rad, 1e-9);
    }
}

TEST(PlaneBelow, HasTheParallaxThatTheProjectionHas) {
  const StereoCamera camera{.fx_px = 700,
                            .fy_px = 650,
                            .cx_px = 600,
                            .cx_right_px = 600,
                            .cy_px = 180,
                            .baseline_m = 0.5,
                            .mount = {1.3, radians(7), radians(-4)}};
  const GroundPlane plane = plane_below(camera.mount, camera.fx_px * camera.baseline_m);
  for (const double u_px : {0.0, 500.0, 1200.0}) {
    const SeenPlace place{(u_px - camera.cx_px) / camera.fx_px, (300.0 - camera.cy_px) / camera.fy_px, 0.0};
    EXPECT_NEAR(plane.parallax_px(place), Projection(camera).road_parallax_px(u_px, 300.0, {}), 1e-9);
  }
}

TEST(FitGround, FindsNothingAmongTwoPlaces) {
  EXPECT_FALSE(fit_ground({700.0, kScale_px_m, {{0, 0, 1}, {0, 0.1, 5}}}, {}));
}

TEST(FitGround, KeepsToItsLimits) {
  const SeenPlaces seen = places_above({2.0, 0.0, 0.0});
  EXPECT_TRUE(fit_ground(seen, {.max_height_m = 2.1}));
  EXPECT_FALSE(fit_ground(seen, {.max_height_m = 1.0}));
}

TEST(GroundSupport, CountsPlacesOnThePlaneLessThoseBelowIt) {
  const GroundPlane plane{0.0, 100.0, 0.0};
  SeenPlaces seen{700.0, kScale_px_m, {{0.0, 0.1, 10.0}, {0.1, 0.2, 20.0}}};
  EXPECT_DOUBLE_EQ(ground_support(seen, plane), 2.0);
  seen.places.push_back({0.0, 0.1, 30.0});  // an obstacle
  EXPECT_DOUBLE_EQ(ground_support(seen, plane), 2.0);
  seen.places.push_back({0.0, 0.1, 4.0});  // below the ground
  EXPECT_DOUBLE_EQ(ground_support(seen, plane), 1.0);
  seen.places.push_back({0.0, -0.1, 4.0});  // above the horizon
  EXPECT_DOUBLE_EQ(ground_support(seen, plane), 1.0);
}

TEST(DepthRatioOn, TellsAWallThatThePlaneCutsFromGround) {
  const GroundPlane plane{0.0, 100.0, 0.0};
  SeenPlaces ground{700.0, kScale_px_m, {}}, wall = ground;
  for (int row = 0; row <= 20; ++row) {
    const double down = 0.1 + 0.01 * row;
    ground.places.push_back({0.0, down, 100.0 * down});
    wall.places.push_back({0.0, down, 20.0});
  }
  EXPECT_NEAR(depth_ratio_on(ground, plane), 28.0 / 12.0, 1e-9);
  EXPECT_LT(depth_ratio_on(wall, plane), 1.1);
  EXPECT_EQ(depth_ratio_on({700.0, kScale_px_m, {}}, plane), 1.0);
}

}  // namespace
}  // namespace flies
