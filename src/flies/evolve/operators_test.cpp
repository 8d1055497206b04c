#include "flies/evolve/operators.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace flies {
namespace {

/// Five standard errors of a mean of 1000 draws with unit variance.
constexpr int kDraws = 1000;
constexpr double kMeanTolerance = 5.0 / 31.6;

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
  Habitat habitat() const { return {Projection(camera()), {pixels_.data(), 640, 480, 640}, {}, {}}; }
  static FlyRandom random(int i) { return {1, 0, 0, static_cast<std::uint32_t>(i)}; }

  /// A fly that falls on left pixel (u, v) with this disparity.
  Population flies_at(const std::vector<StereoPoint>& points, const std::vector<float>& fitness) const {
    Population flies;
    for (std::size_t i = 0; i < points.size(); ++i)
      flies.push_back(habitat().projection.triangulate(points[i]), fitness[i]);
    return flies;
  }

  std::vector<std::uint8_t> pixels_;
};

TEST_F(OperatorsTest, SpawnStaysInTheHabitat) {
  for (const auto distribution : {InitialDistribution::image, InitialDistribution::space})
    for (int i = 0; i < kDraws; ++i) {
      auto r = random(i);
      EXPECT_TRUE(in_habitat(habitat(), spawn(habitat(), distribution, 0.0, r)));
    }
}

TEST_F(OperatorsTest, SpawnSpreadsDisparityOrDistanceEvenly) {
  const auto mean = [&](InitialDistribution distribution, auto value) {
    double sum = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      auto r = random(i);
      sum += value(spawn(habitat(), distribution, 0.0, r)) / kDraws;
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

TEST_F(OperatorsTest, SpawnPrefersInformativePlaces) {
  int informative = 0;
  for (int i = 0; i < kDraws; ++i) {
    auto r = random(i);
    informative += habitat().projection.project(spawn(habitat(), InitialDistribution::image, 20.0, r)).u_px > 310.0;
  }
  EXPECT_GT(informative, 0.99 * kDraws);
}

TEST_F(OperatorsTest, RowContrastIsTheSpreadOfGreyLevelsInAPatch) {
  EXPECT_EQ(row_contrast(habitat().left, {100, 100, 0}), 0);
  EXPECT_EQ(row_contrast(habitat().left, {400, 100, 0}), 60);
  EXPECT_EQ(row_contrast(habitat().left, {639, 479, 0}), 60);
  EXPECT_EQ(row_contrast(habitat().left, {-1, 100, 0}), 0);
}

TEST_F(OperatorsTest, CrowdingCountsOwnCellTwiceAndFourNeighboursOnce) {
  // Cells of 10 px: three flies in one cell, one in the cell to the right, one diagonal, one far away.
  const auto flies =
      flies_at({{105, 105, 10}, {106, 106, 20}, {107, 101, 30}, {115, 105, 10}, {115, 115, 10}, {305, 305, 10}},
               {1, 1, 1, 1, 1, 1});
  EXPECT_THAT(crowding(habitat(), flies, 10), testing::ElementsAre(3.5F, 3.5F, 3.5F, 3.0F, 1.5F, 1.0F));
}

TEST_F(OperatorsTest, CrowdingLeavesFliesOutsideTheImageAlone) {
  Population flies;
  flies.push_back({-5, 0, 1});
  flies.push_back({5, 100, 1});
  EXPECT_THAT(crowding(habitat(), flies, 10), testing::ElementsAre(1.0F, 1.0F));
}

TEST(ShareFitness, DividesByAPowerOfTheCrowding) {
  const std::vector<float> fitness{8, 8}, crowds{4, 1};
  EXPECT_THAT(share_fitness(fitness, crowds, 1.0), testing::ElementsAre(2.0F, 8.0F));
  EXPECT_THAT(share_fitness(fitness, crowds, 0.5), testing::ElementsAre(4.0F, 8.0F));
  EXPECT_THAT(share_fitness(fitness, crowds, 0.0), testing::ElementsAre(8.0F, 8.0F));
}

TEST(SelectFittest, KeepsTheLargestAndBreaksTiesByIndex) {
  const std::vector<float> fitness{3, 9, 5, 9, 5, 5};
  EXPECT_THAT(select_fittest(fitness, 3), testing::ElementsAre(1U, 2U, 3U));
  EXPECT_THAT(select_fittest(fitness, 0), testing::IsEmpty());
  EXPECT_THAT(select_fittest(fitness, 99), testing::ElementsAre(0U, 1U, 2U, 3U, 4U, 5U));
}

TEST_F(OperatorsTest, UniquenessMarksTheWeakerOfTwoFliesOnTheSameLeftPixels) {
  const auto flies = flies_at({{200, 240, 20}, {202, 241, 30}, {330, 240, 45}}, {5, 3, 1});
  EXPECT_THAT(find_rivalled(habitat(), flies, {}), testing::ElementsAre(false, true, false));
}

TEST_F(OperatorsTest, UniquenessMarksTheWeakerOfTwoFliesOnTheSameRightPixels) {
  // Right columns 180 and 181.
  const auto flies = flies_at({{200, 240, 20}, {221, 240, 40}}, {5, 3});
  EXPECT_THAT(find_rivalled(habitat(), flies, {}), testing::ElementsAre(false, true));
}

TEST_F(OperatorsTest, UniquenessSparesFliesOfTheSameSurface) {
  const auto flies = flies_at({{200, 240, 20}, {202, 241, 21}, {200, 260, 35}}, {5, 3, 1});
  EXPECT_THAT(find_rivalled(habitat(), flies, {}), testing::ElementsAre(false, false, false));
}

TEST_F(OperatorsTest, MutationMovesByItsDeviations) {
  const Point3 parent = habitat().projection.triangulate({320, 240, 25});
  double u = 0.0, uu = 0.0, dd = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    auto r = random(i);
    const auto child =
        habitat().projection.project(mutate(habitat(), {.image_px = 4, .disparity_px = 2}, 0.5, parent, r));
    u += (child.u_px - 320) / kDraws;
    uu += std::pow(child.u_px - 320, 2) / kDraws;
    dd += std::pow(child.disparity_px - 25, 2) / kDraws;
  }
  EXPECT_NEAR(u / 2.0, 0.0, kMeanTolerance);
  EXPECT_NEAR(uu / 4.0, 1.0, 2.0 * kMeanTolerance);
  EXPECT_NEAR(dd, 1.0, 2.0 * kMeanTolerance);
}

TEST_F(OperatorsTest, MutationKeepsTheParentWhenNoChildFits) {
  const Point3 outside{1.0, 0.0, 1.0};
  auto r = random(0);
  EXPECT_EQ(mutate(habitat(), {.image_px = 0, .disparity_px = 0}, 1.0, outside, r).x_m, outside.x_m);
}

TEST(Cross, BearsAChildBetweenItsParents) {
  for (std::uint32_t i = 0; i < 100; ++i) {
    FlyRandom random(1, 0, 0, i);
    const auto child = cross({10, -2, 0.5}, {20, 4, 1.5}, random);
    const double share = (child.x_m - 10) / 10;
    EXPECT_GE(share, 0.0);
    EXPECT_LE(share, 1.0);
    EXPECT_NEAR(child.y_m, -2 + 6 * share, 1e-9);
    EXPECT_NEAR(child.z_m, 0.5 + share, 1e-9);
  }
}

TEST_F(OperatorsTest, SteeringDrawsOnTheObstacle) {
  const std::vector<Obstacle> obstacles{
      {.x_m = 15, .y_m = 3, .range_m = 15.3, .width_m = 0.6, .height_m = 1.7, .box = {}}};
  double x = 0.0, y = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    auto r = random(i);
    const auto p = steer(habitat(), obstacles, r);
    x += p.x_m / kDraws;
    y += p.y_m / kDraws;
    EXPECT_GE(p.z_m, FieldOptions{}.z_min_m);
    EXPECT_LE(p.z_m, 1.7);
  }
  EXPECT_NEAR(x, 15.0, kMeanTolerance);
  EXPECT_NEAR(y, 3.0, kMeanTolerance);
}

}  // namespace
}  // namespace flies
