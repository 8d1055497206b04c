#include "flies/evolve/niches.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "flies/core/random.hpp"

namespace flies {
namespace {

constexpr int kWidth_px = 640, kHeight_px = 480;

ImagePopulation flies_at(const std::vector<StereoPoint>& points, const std::vector<float>& fitness) {
  ImagePopulation flies;
  flies.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) flies.set(i, points[i], fitness[i]);
  return flies;
}

/// Each function is called twice on the same memory: the second time must not see the first.
template <class T, class Call>
std::vector<T> called_twice(const Call& call) {
  std::vector<T> result;
  call(result);
  call(result);
  return result;
}

std::vector<float> crowding(const ImagePopulation& flies, int cell_px) {
  CrowdingGrid grid;
  return called_twice<float>([&](auto& result) { find_crowding(flies, kWidth_px, kHeight_px, cell_px, grid, result); });
}

std::vector<std::uint8_t> rivalled(const ImagePopulation& flies, const UniquenessOptions& options = {}) {
  UniquenessGrid grid;
  return called_twice<std::uint8_t>(
      [&](auto& result) { find_rivalled(flies, kWidth_px, kHeight_px, options, grid, result); });
}

std::vector<float> shared(const std::vector<float>& fitness, const std::vector<float>& crowds, double strength) {
  return called_twice<float>([&](auto& result) { share_fitness(fitness, crowds, strength, result); });
}

std::vector<std::uint32_t> fittest(const std::vector<float>& fitness, std::size_t count) {
  return called_twice<std::uint32_t>([&](auto& result) { select_fittest(fitness, count, result); });
}

TEST(FindCrowding, CountsOwnCellTwiceAndFourNeighboursOnce) {
  // Cells of 10 px: three flies in one cell, one in the cell to the right, one diagonal, one far away.
  const auto flies =
      flies_at({{105, 105, 10}, {106, 106, 20}, {107, 101, 30}, {115, 105, 10}, {115, 115, 10}, {305, 305, 10}},
               {1, 1, 1, 1, 1, 1});
  EXPECT_THAT(crowding(flies, 10), testing::ElementsAre(3.5F, 3.5F, 3.5F, 3.0F, 1.5F, 1.0F));
}

TEST(FindCrowding, LeavesFliesOutsideTheImageAlone) {
  const auto flies =
      flies_at({{-1, 100, 9}, {100, 481, 9}, {std::nan(""), 5, 9}, {0, 0, 9}, {639, 479, 9}}, {1, 1, 1, 1, 1});
  EXPECT_THAT(crowding(flies, 10), testing::Each(1.0F));
}

TEST(ShareFitness, DividesByAPowerOfTheCrowding) {
  const std::vector<float> fitness{8, 8}, crowds{4, 1};
  EXPECT_THAT(shared(fitness, crowds, 1.0), testing::ElementsAre(2.0F, 8.0F));
  EXPECT_THAT(shared(fitness, crowds, 0.5), testing::ElementsAre(4.0F, 8.0F));
  EXPECT_THAT(shared(fitness, crowds, 0.0), testing::ElementsAre(8.0F, 8.0F));
}

TEST(SelectFittest, KeepsTheLargestAndBreaksTiesByIndex) {
  const std::vector<float> fitness{3, 9, 5, 9, 5, 5};
  EXPECT_THAT(fittest(fitness, 3), testing::ElementsAre(1U, 2U, 3U));
  EXPECT_THAT(fittest(fitness, 0), testing::IsEmpty());
  EXPECT_THAT(fittest(fitness, 99), testing::ElementsAre(0U, 1U, 2U, 3U, 4U, 5U));
}

TEST(SelectFittest, AgreesWithSortingAtEveryCount) {
  std::vector<float> fitness;
  FlyRandom random(5, 0, 0, 0);
  for (int i = 0; i < 300; ++i) {
    // Values of all magnitudes, many of them equal or 0.
    const double value = std::exp(random.uniform(-60, 60));
    fitness.push_back(i % 3 == 0 ? 0.0F : static_cast<float>(i % 3 == 1 ? value : std::floor(4 * random.uniform())));
  }
  std::vector<std::uint32_t> order(fitness.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return fitness[a] > fitness[b]; });
  for (std::size_t count = 0; count <= fitness.size(); ++count) {
    std::vector<std::uint32_t> expected(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count));
    std::sort(expected.begin(), expected.end());
    ASSERT_EQ(fittest(fitness, count), expected) << count;
  }
}

TEST(FindRivalled, MarksTheWeakerOfTwoFliesOnTheSameLeftPixels) {
  const auto flies = flies_at({{200, 240, 20}, {202, 241, 30}, {330, 240, 45}}, {5, 3, 1});
  EXPECT_THAT(rivalled(flies), testing::ElementsAre(0, 1, 0));
}

TEST(FindRivalled, MarksTheWeakerOfTwoFliesOnTheSameRightPixels) {
  // Right columns 180 and 181.
  const auto flies = flies_at({{200, 240, 20}, {221, 240, 40}}, {5, 3});
  EXPECT_THAT(rivalled(flies), testing::ElementsAre(0, 1));
}

TEST(FindRivalled, SparesFliesOfTheSameSurface) {
  const auto flies = flies_at({{200, 240, 20}, {202, 241, 21}, {200, 260, 35}}, {5, 3, 1});
  EXPECT_THAT(rivalled(flies), testing::ElementsAre(0, 0, 0));
}

TEST(FindRivalled, SparesFliesThatAreNearlyAsFit) {
  const auto flies = flies_at({{200, 240, 20}, {202, 241, 30}}, {5, 3});
  EXPECT_THAT(rivalled(flies, {.margin = 2.0}), testing::ElementsAre(0, 0));
}

TEST(FindRivalled, FindsRivalsInAllNeighbouringCells) {
  // Cells of 5 x 7 px; the fitter one in the middle of its cell, the other just across one of its borders or corners.
  for (const double du : {-4.0, 0.0, 4.0})
    for (const double dv : {-5.0, 0.0, 5.0}) {
      const auto flies = flies_at({{202.5, 241.5, 20}, {202.5 + du, 241.5 + dv, 26}}, {5, 3});
      EXPECT_THAT(rivalled(flies), testing::ElementsAre(0, 1)) << du << ' ' << dv;
    }
}

}  // namespace
}  // namespace flies
