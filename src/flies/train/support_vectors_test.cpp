#include "flies/train/support_vectors.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "flies/core/random.hpp"
#include "flies/train/principal_axes.hpp"

namespace flies {
namespace {

struct Points {
  Matrix features;
  std::vector<char> is_person;
};

/// People inside a circle, background around it: no line separates them.
Points ring(int count) {
  Points points;
  points.features.columns = 3;
  FlyRandom random(1, 0, 0, 0);
  for (int i = 0; i < count; ++i) {
    const bool person = i % 2 == 0;
    const double radius = person ? random.uniform(0.0, 0.5) : random.uniform(1.0, 1.5);
    const double angle = random.uniform(0.0, 6.28);
    for (const double value : {radius * std::cos(angle), radius * std::sin(angle), 0.01 * random.normal()})
      points.features.values.push_back(static_cast<float>(value));
    points.is_person.push_back(person);
    ++points.features.rows;
  }
  return points;
}

template <class Score>
double share_right(const Points& points, const Score& score) {
  int right = 0;
  for (std::size_t i = 0; i < points.features.rows; ++i)
    right += (score(points.features.row(i)) > 0.0) == (points.is_person[i] != 0);
  return static_cast<double>(right) / static_cast<double>(points.features.rows);
}

TEST(TrainLinear, SeparatesWhatALineSeparates) {
  Points points = ring(200);
  for (std::size_t i = 0; i < points.features.rows; ++i)
    points.features.values[3 * i] += points.is_person[i] ? 4.0F : -4.0F;
  for (const bool person_first : {true, false}) {  // both libraries name the classes by the first row
    if (!person_first) points.is_person[0] = 0, points.features.values[0] = -4.0F;
    const LinearStage stage = train_linear(points.features, points.is_person, {1.0}, 1);
    EXPECT_EQ(share_right(points, [&](auto row) { return linear_score(stage, row); }), 1.0);
  }
}

TEST(TrainLinear, GivesTheSameTwice) {
  const Points points = ring(200);
  const LinearStage a = train_linear(points.features, points.is_person, {1.0}, 5);
  const LinearStage b = train_linear(points.features, points.is_person, {1.0}, 5);
  EXPECT_EQ(a.weights, b.weights);
  EXPECT_EQ(a.bias, b.bias);
}

TEST(TrainKernel, SeparatesARingWhereALineCannot) {
  const Points points = ring(300);
  const LinearStage linear = train_linear(points.features, points.is_person, {1.0}, 1);
  EXPECT_LT(share_right(points, [&](auto row) { return linear_score(linear, row); }), 0.8);
  KernelSvmOptions options;
  options.gamma = 2.0;
  options.projection = 2;
  const KernelStage kernel = train_kernel(points.features, points.is_person, options, 1);
  EXPECT_EQ(kernel.projection.rows, 2U);
  EXPECT_EQ(share_right(points, [&](auto row) { return kernel_score(kernel, row); }), 1.0);
}

TEST(PrincipalAxes, FindsTheDirectionsOfLargestVariance) {
  constexpr float kTolerance = 0.02F;  // 5000 draws
  Matrix rows{5000, 4, {}};
  FlyRandom random(2, 0, 0, 0);
  for (std::size_t i = 0; i < rows.rows; ++i) {
    const double a = 3.0 * random.normal(), b = random.normal();
    for (const double value : {0.6 * a + 5.0, 0.8 * a, b, 0.1 * random.normal()})
      rows.values.push_back(static_cast<float>(value));
  }
  const PrincipalAxes found = principal_axes(rows, 2, 1);
  EXPECT_NEAR(found.mean[0], 5.0F, 0.1F);
  const float sign = found.axes.row(0)[0] > 0 ? 1.0F : -1.0F;
  EXPECT_NEAR(sign * found.axes.row(0)[0], 0.6F, kTolerance);
  EXPECT_NEAR(sign * found.axes.row(0)[1], 0.8F, kTolerance);
  EXPECT_NEAR(std::abs(found.axes.row(1)[2]), 1.0F, kTolerance);

  const Matrix coordinates = project(rows, found.mean, found.axes);
  double variance = 0.0;
  for (std::size_t i = 0; i < rows.rows; ++i) variance += coordinates.row(i)[0] * coordinates.row(i)[0];
  EXPECT_NEAR(variance / 5000.0, 9.0, 0.5);
}

TEST(PrincipalAxes, GivesNoMoreThanThereAre) {
  const Matrix rows{3, 2, {0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 1.0F}};
  EXPECT_EQ(principal_axes(rows, 10, 1).axes.rows, 2U);
}

}  // namespace
}  // namespace flies
