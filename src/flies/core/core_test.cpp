#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <vector>

#include "flies/core/convert.hpp"
#include "flies/core/error.hpp"
#include "flies/core/field.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/parabola.hpp"
#include "flies/core/planar_motion.hpp"
#include "flies/core/random.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/core/waiting.hpp"

namespace flies {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Rounding of double arithmetic over a few dozen operations on metres and pixels.
constexpr double kRounding = 1e-9;

StereoCamera level_camera() {
  return {.fx_px = 700,
          .fy_px = 710,
          .cx_px = 320,
          .cx_right_px = 320,
          .cy_px = 240,
          .baseline_m = 0.5,
          .width_px = 640,
          .height_px = 480,
          .mount = {.height_m = 1.5}};
}

StereoCamera tilted_camera() {
  auto camera = level_camera();
  camera.mount.pitch_rad = radians(3.0);
  camera.mount.roll_rad = radians(-2.0);
  return camera;
}

TEST(Projection, FollowsTheFormulasOfALevelCamera) {
  const auto camera = level_camera();
  const Point3 fly{12.0, -1.5, 0.8};
  const auto image = Projection(camera).project(fly);
  EXPECT_NEAR(image.u_px, camera.cx_px - camera.fx_px * fly.y_m / fly.x_m, kRounding);
  EXPECT_NEAR(image.v_px, camera.cy_px - camera.fy_px * (fly.z_m - camera.mount.height_m) / fly.x_m, kRounding);
  EXPECT_NEAR(image.disparity_px, camera.fx_px * camera.baseline_m / fly.x_m, kRounding);
}

TEST(Projection, LooksDownWithPositivePitch) {
  auto camera = level_camera();
  camera.mount.pitch_rad = radians(10.0);
  // The optical axis meets the ground at height / tan(pitch).
  const Point3 ground{camera.mount.height_m / std::tan(radians(10.0)), 0.0, 0.0};
  const auto image = Projection(camera).project(ground);
  EXPECT_NEAR(image.u_px, camera.cx_px, kRounding);
  EXPECT_NEAR(image.v_px, camera.cy_px, kRounding);
}

TEST(Projection, RaisesItsLeftSideWithPositiveRoll) {
  auto camera = level_camera();
  camera.mount.roll_rad = radians(5.0);
  const Projection projection(camera);
  // Raising the camera's left side lowers what it sees on the left: larger v.
  const auto left = projection.project({10.0, 2.0, camera.mount.height_m});
  const auto right = projection.project({10.0, -2.0, camera.mount.height_m});
  EXPECT_GT(left.v_px, camera.cy_px);
  EXPECT_LT(right.v_px, camera.cy_px);
}

TEST(Projection, TriangulatesWhatItProjected) {
  auto camera = tilted_camera();
  camera.cx_right_px = camera.cx_px + 7.0;
  const Projection projection(camera);
  for (const Point3& p : {Point3{5, 1, 0}, Point3{20, -6, 2.5}, Point3{80, 0, -1}}) {
    const Point3 back = projection.triangulate(projection.project(p));
    EXPECT_NEAR(back.x_m, p.x_m, kRounding * p.x_m);
    EXPECT_NEAR(back.y_m, p.y_m, kRounding * p.x_m);
    EXPECT_NEAR(back.z_m, p.z_m, kRounding * p.x_m);
  }
}

TEST(Projection, ShiftsDisparityByThePrincipalPoints) {
  auto camera = level_camera();
  camera.cx_right_px = camera.cx_px + 7.0;
  EXPECT_NEAR(Projection(camera).project({10, 0, 1}).disparity_px, 700 * 0.5 / 10 - 7.0, kRounding);
}

TEST(Projection, MeetsTheRoadWhereTheRoadProjects) {
  const Projection projection(tilted_camera());
  const RoadPlane road{.height_m = 0.1, .slope = 0.02, .bank = -0.03};
  const Point3 point{15.0, 2.0, road.z_m(15.0, 2.0)};
  const auto image = projection.project(point);
  const Point3 met = projection.meet_road(image.u_px, image.v_px, road);
  EXPECT_NEAR(met.x_m, point.x_m, 1e-7);
  EXPECT_NEAR(met.y_m, point.y_m, 1e-7);
  EXPECT_NEAR(met.z_m, point.z_m, 1e-7);
}

TEST(Projection, MeetsNoRoadAboveTheHorizon) { EXPECT_LE(Projection(level_camera()).meet_road(320, 100, {}).x_m, 0.0); }

struct BadCamera {
  const char* field;
  void (*spoil)(StereoCamera&);
};

class CheckCamera : public testing::TestWithParam<BadCamera> {};

TEST_P(CheckCamera, NamesTheFieldAtFault) {
  auto camera = level_camera();
  check_camera(camera, "calib.yaml");
  GetParam().spoil(camera);
  EXPECT_THAT([&] { check_camera(camera, "calib.yaml"); },
              ThrowsMessage<InputError>(testing::AllOf(HasSubstr("calib.yaml: "), HasSubstr(GetParam().field))));
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
INSTANTIATE_TEST_SUITE_P(BadInput, CheckCamera,
                         testing::Values(BadCamera{"fx_px", [](StereoCamera& c) { c.fx_px = 0.0; }},
                                         BadCamera{"fx_px", [](StereoCamera& c) { c.fx_px = kNan; }},
                                         BadCamera{"fy_px", [](StereoCamera& c) { c.fy_px = -700.0; }},
                                         BadCamera{"cx_px", [](StereoCamera& c) { c.cx_px = kNan; }},
                                         BadCamera{"cy_px", [](StereoCamera& c) { c.cy_px = 5000.0; }},
                                         BadCamera{"baseline_m", [](StereoCamera& c) { c.baseline_m = -0.5; }},
                                         BadCamera{"baseline_m", [](StereoCamera& c) { c.baseline_m = INFINITY; }},
                                         BadCamera{"height_m", [](StereoCamera& c) { c.mount.height_m = 0.0; }},
                                         BadCamera{"fx_px", [](StereoCamera& c) { c.fx_px = 1e300; }},
                                         BadCamera{"fy_px", [](StereoCamera& c) { c.fy_px = 1e-300; }},
                                         BadCamera{"baseline_m", [](StereoCamera& c) { c.baseline_m = 1e5; }},
                                         BadCamera{"baseline_m", [](StereoCamera& c) { c.baseline_m = 1e-5; }},
                                         BadCamera{"height_m", [](StereoCamera& c) { c.mount.height_m = 1e5; }},
                                         BadCamera{"width_px", [](StereoCamera& c) { c.width_px = -1; }},
                                         BadCamera{"height_px", [](StereoCamera& c) { c.height_px = 1 << 30; }},
                                         BadCamera{"cx_right_px",
                                                   [](StereoCamera& c) {
                                                     c.width_px = c.height_px = 0;
                                                     c.cx_right_px = 1e9;
                                                   }},
                                         BadCamera{"cx_right_px", [](StereoCamera& c) { c.cx_right_px = 0; }},
                                         BadCamera{"image size", [](StereoCamera& c) { c.width_px = 0; }},
                                         BadCamera{"image size", [](StereoCamera& c) { c.height_px = 0; }},
                                         BadCamera{"pitch_deg",
                                                   [](StereoCamera& c) { c.mount.pitch_rad = radians(60); }},
                                         BadCamera{"roll_deg", [](StereoCamera& c) { c.mount.roll_rad = kNan; }}));

TEST(CheckCameraFits, RefusesImagesOfAnotherSize) {
  EXPECT_NO_THROW(check_camera_fits(level_camera(), 640, 480, "c"));
  EXPECT_THAT([] { check_camera_fits(level_camera(), 480, 640, "c"); },
              ThrowsMessage<InputError>(HasSubstr("are they turned by 90 degrees?")));
  EXPECT_THAT([] { check_camera_fits(level_camera(), 320, 240, "c"); },
              ThrowsMessage<InputError>(testing::AllOf(HasSubstr("640 x 480"), HasSubstr("320 x 240"))));
}

TEST(CheckCameraFits, LooksAtThePrincipalPointWhenTheFileGivesNoSize) {
  auto camera = level_camera();
  camera.width_px = camera.height_px = 0;
  EXPECT_NO_THROW(check_camera_fits(camera, 640, 480, "c"));
  EXPECT_THROW(check_camera_fits(camera, 300, 480, "c"), InputError);
}

TEST(CheckPair, RefusesEmptyAndUnequalImages) {
  const std::vector<std::uint8_t> pixels(12);
  const GrayView wide{pixels.data(), 4, 3, 4}, tall{pixels.data(), 3, 4, 3};
  EXPECT_NO_THROW(check_pair({wide, wide}));
  EXPECT_THAT(
      [&] {
        check_pair({wide, tall}, "a.png", "b.png");
      },
      ThrowsMessage<InputError>(testing::AllOf(HasSubstr("a.png"), HasSubstr("b.png"), HasSubstr("3 x 4"))));
  EXPECT_THAT([&] { check_pair({{}, wide}, "a.png", "b.png"); }, ThrowsMessage<InputError>(HasSubstr("a.png")));
}

TEST(CheckField, RefusesAnEmptyInterval) {
  EXPECT_NO_THROW(check_field({}, "options"));
  EXPECT_THAT([] { check_field({.x_min_m = 50.0, .x_max_m = 20.0}, "options"); },
              ThrowsMessage<InputError>(HasSubstr("field.x_min_m")));
}

TEST(InField, MeasuresHeightFromTheRoad) {
  const FieldOptions field{.z_min_m = 0.2, .z_max_m = 2.0};
  EXPECT_TRUE(in_field(field, {.height_m = 1.0}, {10, 0, 1.5}));
  EXPECT_FALSE(in_field(field, {.height_m = 1.0}, {10, 0, 1.1}));
  EXPECT_FALSE(in_field(field, {}, {kNan, 0, 1.0}));
}

TEST(Philox, MatchesTheKnownAnswersOfItsAuthors) {
  // From the known-answer file of the Random123 library, philox4x32 with 10 rounds.
  EXPECT_EQ(philox({0, 0, 0, 0}, 0), (std::array<std::uint32_t, 4>{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, 0xffffffffffffffff),
            (std::array<std::uint32_t, 4>{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
}

TEST(QuickPhilox, MatchesTheKnownAnswersOfItsAuthors) {
  // From the known-answer file of the Random123 library, philox2x64 with 7 rounds; low halves of words first.
  EXPECT_EQ(quick_philox({0, 0}, 0), (RandomWords{0xbfefc666, 0xb41da69f, 0xa5534056, 0x511e9ce1}));
  EXPECT_EQ(quick_philox({0x243f6a8885a308d3, 0x13198a2e03707344}, 0xa4093822299f31d0),
            (RandomWords{0x392bf372, 0x98ed1534, 0x68882fd5, 0x67528b15}));
}

TEST(FlyDraws, AreAFunctionOfSeedPurposeGenerationFlyAndNumber) {
  FlyDraws draws(1, 2, 3, 4);
  const auto first = draws.next(), second = draws.next();
  EXPECT_EQ(FlyDraws(1, 2, 3, 4).next(), first);
  EXPECT_NE(second, first);
  EXPECT_NE(FlyDraws(9, 2, 3, 4).next(), first);
  EXPECT_NE(FlyDraws(1, 9, 3, 4).next(), first);
  EXPECT_NE(FlyDraws(1, 2, 9, 4).next(), first);
  EXPECT_NE(FlyDraws(1, 2, 3, 9).next(), first);
}

TEST(StandardNormal, FollowsTheNormalDistribution) {
  EXPECT_EQ(std::abs(standard_normal(0)), 0.0);
  constexpr int kWords = 1 << 20;
  double sum = 0.0, squares = 0.0;
  for (std::uint32_t i = 0; i < kWords; ++i) {
    // Evenly spread over all words: the sign is the last bit.
    for (const std::uint32_t sign : {0u, 1u}) {
      const double z = standard_normal(i << 12 | sign);
      sum += z;
      squares += z * z;
      if (i % 1024 == 0) {
        const double below = 0.5 * (1.0 + std::erf(z / std::sqrt(2.0)));
        const double share = 0.5 + (sign == 0 ? 0.5 : -0.5) * i / kWords;
        EXPECT_NEAR(below, share, 1.4e-4) << i;  // as the comment of the function says
      }
    }
  }
  EXPECT_NEAR(sum, 0.0, 1e-6 * kWords);
  EXPECT_NEAR(squares / (2.0 * kWords), 1.0, 1e-4);  // of the spacing of the words
}

TEST(FlyRandom, IsAFunctionOfSeedPurposeGenerationAndFly) {
  const auto first = [](std::uint64_t seed, std::uint32_t purpose, std::uint32_t generation, std::uint32_t fly) {
    return FlyRandom(seed, purpose, generation, fly).bits();
  };
  const auto reference = first(1, 2, 3, 4);
  EXPECT_EQ(first(1, 2, 3, 4), reference);
  EXPECT_NE(first(9, 2, 3, 4), reference);
  EXPECT_NE(first(1, 9, 3, 4), reference);
  EXPECT_NE(first(1, 2, 9, 4), reference);
  EXPECT_NE(first(1, 2, 3, 9), reference);
}

TEST(FlyRandom, DrawsTheMomentsOfItsDistributions) {
  constexpr int kDraws = 100'000;
  // Five standard errors of the mean of that many draws with unit variance.
  constexpr double kTolerance = 5.0 / 316.0;
  double uniform = 0.0, normal = 0.0, square = 0.0;
  FlyRandom random(7, 0, 0, 0);
  for (int i = 0; i < kDraws; ++i) {
    uniform += random.uniform() / kDraws;
    const double n = random.normal();
    normal += n / kDraws;
    square += n * n / kDraws;
    ASSERT_LT(random.below(3), 3U);
  }
  EXPECT_NEAR(uniform, 0.5, kTolerance);
  EXPECT_NEAR(normal, 0.0, kTolerance);
  EXPECT_NEAR(square, 1.0, 2.0 * kTolerance);
}

TEST(ParabolaVertex, FindsThePeakOrStaysInTheMiddle) {
  const auto parabola = [](double x) { return 5.0 - 2.0 * (x - 0.3) * (x - 0.3); };
  EXPECT_NEAR(parabola_vertex(parabola(-1), parabola(0), parabola(1)), 0.3, kRounding);
  EXPECT_EQ(parabola_vertex(0.0, 1.0, 5.0), 0.0) << "opens upwards";
  EXPECT_EQ(parabola_vertex(1.0, 1.0, 1.0), 0.0) << "flat";
  EXPECT_EQ(parabola_vertex(0.0, 9.9, 10.0), 0.5 * 10.0 / 9.8);
}

TEST(Population, KeepsItsArraysOfEqualLength) {
  Population flies;
  EXPECT_TRUE(flies.empty());
  flies.push_back({1, 2, 3}, 0.5F);
  flies.push_back({4, 5, 6});
  ASSERT_EQ(flies.size(), 2U);
  EXPECT_EQ(flies.point(0).y_m, 2.0);
  EXPECT_EQ(flies.fly(0).fitness, 0.5F);
  EXPECT_EQ(flies.fitness.size(), 2U);
}

TEST(WholeNumber, IsNothingForWhatDoesNotFit) {
  EXPECT_EQ(whole_number<int>(-3.0), -3);
  EXPECT_EQ(whole_number<int>(2147483647.0), 2147483647);
  EXPECT_EQ(whole_number<std::int64_t>(9e18), 9000000000000000000);
  for (const double wrong : {0.5, 2147483648.0, -2147483649.0, 1e30, 1e300, std::nan(""), HUGE_VAL})
    EXPECT_EQ(whole_number<int>(wrong), std::nullopt) << wrong;
  EXPECT_EQ(whole_number<std::int64_t>(9.3e18), std::nullopt);
  EXPECT_EQ(whole_number<std::uint32_t>(-1.0), std::nullopt);
}

TEST(Saturated, IsTheNearestNumberThereIs) {
  EXPECT_EQ(saturated<int>(-3.7), -3);
  EXPECT_EQ(saturated<int>(1e30), std::numeric_limits<int>::max());
  EXPECT_EQ(saturated<int>(-HUGE_VAL), std::numeric_limits<int>::min());
  EXPECT_EQ(saturated<int>(std::nan("")), 0);
  EXPECT_EQ(saturated<std::uint32_t>(-1.0), 0U);
  EXPECT_EQ(saturated<std::uint64_t>(1e30), std::numeric_limits<std::uint64_t>::max());
}

TEST(PlanarMotion, TakesPointsForthAndBack) {
  const PlanarMotion motion{1.0, 0.5,
                            std::numbers::pi / 2};  // one metre ahead, half a metre to the left, then turned left
  const Point3 before{3.0, 0.5, 1.2};               // two metres ahead of where we were going
  const Point3 now = motion.now(before);            // now on the right
  EXPECT_NEAR(now.x_m, 0.0, 1e-12);
  EXPECT_NEAR(now.y_m, -2.0, 1e-12);
  const Point3 back = motion.before(now);
  EXPECT_NEAR(back.x_m, before.x_m, 1e-12);
  EXPECT_NEAR(back.y_m, before.y_m, 1e-12);
  EXPECT_EQ(back.z_m, before.z_m);
}

TEST(PlanarMotion, OneAfterTheOtherIsOne) {
  const PlanarMotion first{1.0, 0.5, 0.4}, second{2.0, -0.3, -0.9};
  const Point3 point{7.0, 2.0, 1.2};
  const Point3 step_by_step = second.now(first.now(point)), at_once = first.then(second).now(point);
  EXPECT_NEAR(at_once.x_m, step_by_step.x_m, 1e-12);
  EXPECT_NEAR(at_once.y_m, step_by_step.y_m, 1e-12);
  EXPECT_NEAR(first.then(second).turn_rad, -0.5, 1e-12);
}

TEST(RangeDeviation, GrowsWithTheSquareOfTheRangeAndIsInverted) {
  const StereoCamera camera{.fx_px = 700, .fy_px = 700, .baseline_m = 0.1, .mount = {}};
  EXPECT_NEAR(range_deviation_m(camera, 40.0) / range_deviation_m(camera, 20.0), 4.0, 0.2);
  EXPECT_NEAR(range_deviation_m(camera, 1.0), 0.015, 0.002);  // near, the share counts alone
  for (const double share : {0.05, 0.15, 0.5}) {
    const double range_m = range_of_deviation_m(camera, share);
    EXPECT_NEAR(range_deviation_m(camera, range_m) / range_m, share, 1e-9);
  }
  EXPECT_EQ(range_of_deviation_m(camera, 0.01), 0.0);
}

TEST(BoundedWait, OverflowsNoClock) {
  using namespace std::chrono_literals;
  const auto now = std::chrono::steady_clock::now();
  EXPECT_GT(now + detail::bounded_wait(std::chrono::milliseconds::max()), now + 24h);
  EXPECT_GT(now + detail::bounded_wait(std::chrono::hours::max()), now + 24h);
  EXPECT_GT(now + detail::bounded_wait(std::chrono::duration<double>(1e300)), now + 24h);
  EXPECT_EQ(detail::bounded_wait(250ms), 250ms);
  EXPECT_EQ(detail::bounded_wait(0ms), 0ms);
  for (const auto nothing : {-1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(detail::bounded_wait(std::chrono::duration<double>(nothing)), 0ms) << nothing;
  EXPECT_EQ(detail::bounded_wait(std::chrono::milliseconds::min()), 0ms);
}

}  // namespace
}  // namespace flies
