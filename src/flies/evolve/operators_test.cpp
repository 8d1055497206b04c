#include "flies/evolve/operators.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace flies {
namespace {

/// Five standard errors of a mean of 1000 draws with unit variance.
constexpr int kDraws = 1000;
constexpr double kMeanTolerance = 5.0 / 31.6;

/// Rounding of double arithmetic over a few dozen operations on metres and pixels.
constexpr double kRounding = 1e-9;

/// Owns a left image whose right half is striped and whose left half is uniform.
class OperatorsTest : public testing::Test {
 protected:
  OperatorsTest() : pixels_(640 * 480, 100) {
    for (std::size_t i = 0; i < pixels_.size(); ++i)
      if (i % 640 >= 320 && i % 8 < 4) pixels_[i] = 160;
  }

  static StereoCamera camera() {
    return {.fx_px = 500,
            .fy_px = 500,
            .cx_px = 320,
            .cx_right_px = 320,
            .cy_px = 240,
            .baseline_m = 0.5,
            .width_px = 640,
            .height_px = 480,
            .mount = {.height_m = 1.5}};
  }
  GrayView image() const { return {pixels_.data(), 640, 480, 640}; }
  /// The same picture in both images: disparities of multiples of the stripes match.
  Habitat habitat() const { return {Projection(camera()), {image(), image()}, {}, {}}; }
  static EvolveOptions spawning(InitialDistribution distribution, double informative_gray) {
    EvolveOptions options;
    options.initial = distribution;
    options.informative_gray = informative_gray;
    return options;
  }
  static FlyDraws draws(int i) { return {1, 0, 0, static_cast<std::uint32_t>(i)}; }

  std::vector<std::uint8_t> pixels_;
};

TEST_F(OperatorsTest, SpawnStaysInTheHabitat) {
  for (const auto distribution : {InitialDistribution::ratios, InitialDistribution::image, InitialDistribution::space})
    for (int i = 0; i < kDraws; ++i) {
      EXPECT_TRUE(habitat().holds(spawn(habitat(), spawning(distribution, 0.0), draws(i))));
    }
}

TEST_F(OperatorsTest, SpawnSpreadsDisparityOrDistanceEvenly) {
  const auto mean = [&](InitialDistribution distribution, auto value) {
    double sum = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      sum += value(habitat().point(spawn(habitat(), spawning(distribution, 0.0), draws(i)))) / kDraws;
    }
    return sum;
  };
  const FieldOptions field;
  // The image distribution is cut by the image's borders, the same at all disparities but the largest.
  const double middle_disparity = 0.5 * (250.0 / field.x_min_m + 250.0 / field.x_max_m);
  EXPECT_NEAR(mean(InitialDistribution::image, [](const Point3& p) { return 250.0 / p.x_m; }), middle_disparity,
              0.1 * middle_disparity);
  EXPECT_GT(mean(InitialDistribution::space, [](const Point3& p) { return p.x_m; }),
            0.5 * (field.x_min_m + field.x_max_m));
}

TEST_F(OperatorsTest, SpawnInRatiosGivesEveryDistanceItsShare) {
  const FieldOptions field;
  const double middle_m = std::sqrt(field.x_min_m * field.x_max_m);
  int nearer = 0;
  for (int i = 0; i < kDraws; ++i)
    nearer += habitat().point(spawn(habitat(), spawning(InitialDistribution::ratios, 0.0), draws(i))).x_m < middle_m;
  // Five standard errors, and a little for the nearest flies that fall outside the image.
  EXPECT_NEAR(nearer, kDraws / 2, 80 + kDraws / 50);
}

TEST_F(OperatorsTest, SightIsBetweenTheDisparitiesThatHold) {
  const auto everywhere = habitat();
  for (const auto& [u_px, v_px] : {std::pair(320.0, 250.0), std::pair(40.0, 300.0), std::pair(600.0, 330.0)}) {
    const auto [least_q_px, most_q_px] = everywhere.sight(u_px, v_px);
    ASSERT_LT(least_q_px, most_q_px);
    for (const double q_px : {0.99 * least_q_px, 1.01 * least_q_px, 0.99 * most_q_px, 1.01 * most_q_px})
      EXPECT_EQ(everywhere.holds({u_px, v_px, everywhere.projection().disparity_offset_px() + q_px}),
                q_px > least_q_px && q_px < most_q_px)
          << u_px << ' ' << q_px;
  }
  const auto sky = everywhere.sight(320, 0);
  EXPECT_GE(sky.least_q_px, sky.most_q_px);
}

TEST_F(OperatorsTest, ScoutFindsTheDisparityWhoseRowMatches) {
  // Random stripes, seen 20 px apart.
  std::vector<std::uint8_t> left(640 * 480), right(640 * 480);
  for (std::size_t v = 0; v < 480; ++v)
    for (std::size_t u = 0; u + 20 < 640; ++u) {
      left[v * 640 + u + 20] = static_cast<std::uint8_t>(FlyRandom(3, 0, 0, static_cast<std::uint32_t>(u)).below(256));
      right[v * 640 + u] = left[v * 640 + u + 20];
    }
  const RectifiedPair pair{{left.data(), 640, 480, 640}, {right.data(), 640, 480, 640}};
  const Habitat in_stripes(Projection(camera()), pair, {}, {});
  int found = 0;
  for (int i = 0; i < kDraws; ++i) {
    const auto best = scout(in_stripes, kernels::kMaxScouts, {300, 270, 15}, draws(i));
    found += std::abs(best.disparity_px - 20.0) <= 0.5;
    EXPECT_TRUE(in_stripes.holds(best));
    EXPECT_EQ(best.u_px, 300);
    EXPECT_EQ(best.v_px, 270);
  }
  // The right column is one of some dozens; 32 scouts see it in more than half of the cases, a stuck fly never.
  EXPECT_GT(found, kDraws / 3);
}

TEST_F(OperatorsTest, ScoutLeavesAFlyWithoutScoutsOrRow) {
  for (const StereoPoint fly : {StereoPoint{2, 270, 20}, StereoPoint{300, 479, 50}, StereoPoint{-10, 270, 20}})
    EXPECT_EQ(scout(habitat(), 8, fly, draws(0)).disparity_px, fly.disparity_px);
  EXPECT_EQ(scout(habitat(), 0, {400, 270, 20}, draws(0)).disparity_px, 20);
}

TEST_F(OperatorsTest, SpawnPrefersInformativePlaces) {
  int informative = 0;
  for (int i = 0; i < kDraws; ++i) {
    informative += spawn(habitat(), spawning(InitialDistribution::image, 20.0), draws(i)).u_px > 310.0;
  }
  EXPECT_GT(informative, 0.99 * kDraws);
}

TEST_F(OperatorsTest, RowContrastIsTheSpreadOfGreyLevelsInAPatch) {
  EXPECT_EQ(row_contrast(habitat().left(), {100, 100, 0}), 0);
  EXPECT_EQ(row_contrast(habitat().left(), {400, 100, 0}), 60);
  EXPECT_EQ(row_contrast(habitat().left(), {639, 479, 0}), 60);
  EXPECT_EQ(row_contrast(habitat().left(), {-1, 100, 0}), 0);
}

TEST_F(OperatorsTest, MutationMovesByItsDeviations) {
  const StereoPoint parent{320, 240, 25};
  double u = 0.0, uu = 0.0, dd = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    auto d = draws(i);
    const auto child = mutate(habitat(), {.image_px = 4, .disparity_px = 2}, 0.5, parent, d);
    u += (child.u_px - 320) / kDraws;
    uu += std::pow(child.u_px - 320, 2) / kDraws;
    dd += std::pow(child.disparity_px - 25, 2) / kDraws;
  }
  EXPECT_NEAR(u / 2.0, 0.0, kMeanTolerance);
  EXPECT_NEAR(uu / 4.0, 1.0, 2.0 * kMeanTolerance);
  EXPECT_NEAR(dd, 1.0, 2.0 * kMeanTolerance);
}

TEST_F(OperatorsTest, MutationKeepsTheParentWhenNoChildFits) {
  const StereoPoint outside{-20, 100, 25};
  auto d = draws(0);
  EXPECT_EQ(mutate(habitat(), {.image_px = 0, .disparity_px = 0}, 1.0, outside, d).u_px, outside.u_px);
}

TEST_F(OperatorsTest, CrossoverWalksEvenlyFromMotherToFather) {
  const Point3 mother{10, -2, 0.5}, father{20, 4, 1.5};
  for (const double share : {0.0, 0.25, 0.7, 1.0}) {
    const auto child = habitat().point(
        cross(habitat(), habitat().projection().project(mother), habitat().projection().project(father), share));
    EXPECT_NEAR(child.x_m, 10 + 10 * share, 1e-9);
    EXPECT_NEAR(child.y_m, -2 + 6 * share, 1e-9);
    EXPECT_NEAR(child.z_m, 0.5 + share, 1e-9);
  }
}

TEST_F(OperatorsTest, SteeringDrawsOnTheObstacle) {
  const std::vector<Obstacle> obstacles{
      {.x_m = 15, .y_m = 3, .range_m = 15.3, .width_m = 0.6, .height_m = 1.7, .box = {}}};
  double x = 0.0, y = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    auto d = draws(i);
    const auto p = habitat().point(steer(habitat(), obstacles, d));
    x += p.x_m / kDraws;
    y += p.y_m / kDraws;
    EXPECT_GE(p.z_m, FieldOptions{}.z_min_m - kRounding);
    EXPECT_LE(p.z_m, 1.7 + kRounding);
  }
  EXPECT_NEAR(x, 15.0, kMeanTolerance);
  EXPECT_NEAR(y, 3.0, kMeanTolerance);
}

/// A camera that is not level over a road that is not flat, and images whose principal points differ.
Habitat tilted_habitat() {
  const StereoCamera camera{.fx_px = 700,
                            .fy_px = 710,
                            .cx_px = 320,
                            .cx_right_px = 327,
                            .cy_px = 240,
                            .baseline_m = 0.5,
                            .mount = {.height_m = 1.5, .pitch_rad = 0.05, .roll_rad = -0.03}};
  return {Projection(camera),
          {{nullptr, 640, 480, 640}, {nullptr, 640, 480, 640}},
          {.height_m = 0.1, .slope = 0.02, .bank = -0.03},
          {}};
}

TEST(Habitat, LocatesFliesAsTheProjectionDoes) {
  const auto habitat = tilted_habitat();
  for (const StereoPoint& fly : {StereoPoint{0, 0, 3}, StereoPoint{300, 250, 20}, StereoPoint{639, 479, 90}}) {
    const Point3 expected = habitat.projection().triangulate(fly), found = habitat.point(fly);
    EXPECT_NEAR(found.x_m, expected.x_m, kRounding * expected.x_m);
    EXPECT_NEAR(found.y_m, expected.y_m, kRounding * expected.x_m);
    EXPECT_NEAR(found.z_m, expected.z_m, kRounding * expected.x_m);
  }
}

TEST(Habitat, PutsFliesAtAHeightAboveTheRoad) {
  const auto habitat = tilted_habitat();
  for (const double height_m : {0.3, 1.7}) {
    const auto fly = habitat.at_height(200, height_m, 12);
    const Point3 point = habitat.point(fly);
    EXPECT_EQ(fly.u_px, 200);
    EXPECT_EQ(fly.disparity_px, 12);
    EXPECT_NEAR(point.z_m - habitat.road().z_m(point.x_m, point.y_m), height_m, kRounding);
  }
}

TEST(Habitat, HoldsWhatIsInTheFieldAndInTheImage) {
  const auto habitat = tilted_habitat();
  int held = 0;
  for (int u = -50; u < 700; u += 25)
    for (int v = -50; v < 530; v += 25)
      for (double disparity_px = -20; disparity_px < 120; disparity_px += 3.3) {
        const StereoPoint fly{1.0 * u, 1.0 * v, disparity_px};
        const bool in_image = u >= 0 && u <= 639 && v >= 0 && v <= 479;
        const bool before_infinity = disparity_px > habitat.projection().disparity_offset_px();
        const bool expected = in_image && before_infinity &&
                              in_field(habitat.field(), habitat.road(), habitat.projection().triangulate(fly));
        EXPECT_EQ(habitat.holds(fly), expected) << u << ' ' << v << ' ' << disparity_px;
        held += expected;
      }
  EXPECT_GT(held, 100);
  EXPECT_FALSE(habitat.holds({std::nan(""), 240, 20}));
  EXPECT_FALSE(habitat.holds({320, 240, std::nan("")}));
}

TEST_F(OperatorsTest, ScoutLeavesAFlyThatIsNowhere) {
  for (const double nowhere : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity(), 1e300, -1e300}) {
    EXPECT_EQ(scout(habitat(), 4, {nowhere, 240, 10}, draws(0)).disparity_px, 10.0) << nowhere;
    EXPECT_EQ(scout(habitat(), 4, {320, nowhere, 10}, draws(0)).disparity_px, 10.0) << nowhere;
  }
}

}  // namespace
}  // namespace flies
