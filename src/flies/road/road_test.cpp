#include "flies/road/road.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "flies/core/random.hpp"
#include "flies/road/textured_road.hpp"

namespace flies {
namespace {

/// How well slope and height of an ideally textured plane must be found: a tenth of a pixel of disparity is 0.0004 in
/// slope here; the texture is interpolated once more by the matching, which costs about as much.
constexpr double kSlopeTolerance = 0.0015;
constexpr double kHeightTolerance_m = 0.03;

StereoCamera camera() {
  return {.fx_px = 500,
          .fy_px = 500,
          .cx_px = 320,
          .cx_right_px = 320,
          .cy_px = 120,
          .baseline_m = 0.5,
          .width_px = 640,
          .height_px = 300,
          .mount = {.height_m = 1.5}};
}

struct Scene {
  std::vector<std::uint8_t> left, right;
  RectifiedPair pair() const { return {{left.data(), 640, 300, 640}, {right.data(), 640, 300, 640}}; }
};

/// A textured plane below a uniform sky, seen by both cameras.
Scene render(const RoadPlane& road, const StereoCamera& stereo = camera()) {
  const Projection projection(stereo);
  Scene scene{std::vector<std::uint8_t>(640 * 300, 128), std::vector<std::uint8_t>(640 * 300, 128)};
  for (int v = 0; v < 300; ++v)
    for (int u = 0; u < 640; ++u) {
      const auto shade = [&](double shift_m) {
        // The right camera sees the road from `baseline` to the right: the same plane moved to the left.
        RoadPlane seen = road;
        seen.height_m += road.bank * -shift_m;
        const Point3 p = projection.meet_road(u, v, seen);
        return p.x_m > 0.0 && p.x_m < 60.0 ? static_cast<std::uint8_t>(60 + 120 * road_texture(p.x_m, p.y_m - shift_m))
                                           : std::uint8_t{128};
      };
      scene.left[static_cast<std::size_t>(v * 640 + u)] = shade(0.0);
      scene.right[static_cast<std::size_t>(v * 640 + u)] = shade(stereo.baseline_m);
    }
  return scene;
}

class EstimateRoad : public testing::TestWithParam<RoadPlane> {};

TEST_P(EstimateRoad, FindsThePlaneOfATexturedRoad) {
  const auto truth = GetParam();
  const auto result = estimate_road(render(truth).pair(), Projection(camera()), {});
  ASSERT_TRUE(result.found);
  EXPECT_NEAR(result.plane.slope, truth.slope, kSlopeTolerance);
  EXPECT_NEAR(result.plane.height_m, truth.height_m, kHeightTolerance_m);
  EXPECT_NEAR(result.plane.bank, truth.bank, 5.0 * kSlopeTolerance);
}

INSTANTIATE_TEST_SUITE_P(Planes, EstimateRoad,
                         testing::Values(RoadPlane{}, RoadPlane{.slope = 0.03}, RoadPlane{.slope = -0.04},
                                         RoadPlane{.height_m = 0.04, .slope = 0.01}, RoadPlane{.bank = 0.02}));

TEST(EstimateRoad, IgnoresAWallThatCoversHalfOfIt) {
  auto scene = render({.slope = 0.02});
  // A wall 9 m ahead fills the left third of the image: disparity 500 * 0.5 / 9.
  constexpr int kDisparity_px = 28;
  for (int v = 0; v < 220; ++v)
    for (int u = 0; u < 220; ++u) {
      FlyRandom random(11, 0, static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v));
      const auto gray = static_cast<std::uint8_t>(random.below(256));
      scene.left[static_cast<std::size_t>(v * 640 + u)] = gray;
      if (u >= kDisparity_px) scene.right[static_cast<std::size_t>(v * 640 + u - kDisparity_px)] = gray;
    }
  const auto result = estimate_road(scene.pair(), Projection(camera()), {});
  ASSERT_TRUE(result.found);
  EXPECT_NEAR(result.plane.slope, 0.02, kSlopeTolerance);
}

TEST(EstimateRoad, FindsItFromHighUpWhereAllSlopesAreWithinAPixel) {
  StereoCamera drone = camera();
  drone.baseline_m = 0.06;
  drone.mount = {.height_m = 7.0, .pitch_rad = radians(30)};
  const auto result = estimate_road(render({}, drone).pair(), Projection(drone), {});
  ASSERT_TRUE(result.found);
  EXPECT_NEAR(result.plane.z_m(12.0, 0.0), 0.0, 0.1);
}

TEST(EstimateRoad, KeepsTheNominalGroundWithoutTexture) {
  const std::vector<std::uint8_t> gray(640 * 300, 100);
  const RectifiedPair pair{{gray.data(), 640, 300, 640}, {gray.data(), 640, 300, 640}};
  const auto result = estimate_road(pair, Projection(camera()), {});
  EXPECT_FALSE(result.found);
  EXPECT_EQ(result.plane.slope, 0.0);
  EXPECT_EQ(result.plane.height_m, 0.0);
}

TEST(EstimateRoad, KeepsTheNominalGroundWhenTheRoadIsSteeperThanAllowed) {
  RoadOptions options;
  options.max_slope = 0.02;
  const auto result = estimate_road(render({.slope = 0.06}).pair(), Projection(camera()), options);
  EXPECT_EQ(result.plane.slope, 0.0);
}

TEST(EstimateRoad, LooksForNothingWhenNotAsked) {
  RoadOptions options;
  options.estimate = false;
  const auto result = estimate_road(render({.slope = 0.03}).pair(), Projection(camera()), options);
  EXPECT_FALSE(result.found);
  EXPECT_TRUE(result.probes.empty());
}

TEST(EstimateRoad, TakesAnImageOfOnePixel) {
  const std::uint8_t pixel = 7;
  EXPECT_FALSE(estimate_road({{&pixel, 1, 1, 1}, {&pixel, 1, 1, 1}}, Projection(camera()), {}).found);
}

TEST(EstimateRoad, BearsCamerasOfAnyScale) {
  const auto scene = render({});
  RoadOptions options;
  options.max_slope = 0.3;
  for (const double focal_px : {1e-3, 1e9})
    for (const double baseline_m : {1e-6, 1e6})
      for (const double height_m : {1e-6, 1e6}) {
        auto absurd = camera();
        absurd.fx_px = absurd.fy_px = focal_px;
        absurd.baseline_m = baseline_m;
        absurd.mount.height_m = height_m;
        const auto result = estimate_road(scene.pair(), Projection(absurd), options);
        EXPECT_LE(std::abs(result.plane.slope), options.max_slope);
        EXPECT_LE(std::abs(result.plane.height_m), options.max_height_m);
      }
}

}  // namespace
}  // namespace flies
