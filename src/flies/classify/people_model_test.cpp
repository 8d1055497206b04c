#include "flies/classify/people_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "flies/classify/named_models.hpp"
#include "flies/classify/svm_scores.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(PeopleModel, NamedModelsAreConsistent) {
  EXPECT_NO_THROW(check_people_model(opencv_48x96(), "48x96"));
  EXPECT_NO_THROW(check_people_model(opencv_64x128(), "64x128"));
  ASSERT_EQ(people_model_names().size(), 5U);
  for (const std::string_view name : people_model_names())
    EXPECT_NO_THROW(check_people_model(people_model(name), std::string(name)));
  EXPECT_TRUE(people_model("flies-48x96").kernel.has_value());
  EXPECT_FALSE(people_model("flies-48x96-linear").kernel.has_value());
  EXPECT_EQ(people_model("opencv-48x96").linear.weights.size(), 1980U);
  EXPECT_EQ(people_model("opencv-64x128").linear.weights.size(), 3780U);
}

TEST(PeopleModel, UnknownNameListsTheKnownOnes) {
  try {
    people_model("opencv-32x64");
    FAIL() << "accepted an unknown name";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("opencv-32x64"), HasSubstr("opencv-48x96"), HasSubstr("opencv-64x128")));
  }
}

TEST(LinearScore, IsTheSameNumberForFeaturesInPieces) {
  constexpr std::size_t kGap = 7;
  for (const std::size_t size : {1U, 16U, 36U, 396U, 397U})
    for (const std::size_t count : {1U, 2U, 5U}) {
      LinearStage stage;
      std::vector<float> joined, apart;
      for (std::size_t i = 0; i < size * count; ++i) {
        stage.weights.push_back(1.0F / static_cast<float>(i + 3));
        joined.push_back(static_cast<float>(i % 13) * 0.1F);
        apart.push_back(joined.back());
        if ((i + 1) % size == 0) apart.insert(apart.end(), kGap, 1e6F);
      }
      EXPECT_EQ(linear_score(stage, FeaturePieces{apart.data(), size, size + kGap, count}), linear_score(stage, joined))
          << size << " x " << count;
    }
}

TEST(KernelScore, IsTheFormula) {
  KernelStage kernel;
  kernel.mean = {1.0F, 2.0F, 3.0F};
  kernel.projection = {2, 3, {1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 1.0F}};
  kernel.support_vectors = {2, 2, {0.5F, 0.0F, 0.0F, 1.0F}};
  kernel.coefficients = {2.0F, -0.5F};
  kernel.gamma = 0.7;
  kernel.bias = 0.25;
  const std::vector<float> features{1.5F, 2.25F, 2.5F};  // projected: 0.5, -0.25
  const double expected = 0.25 + 2.0 * std::exp(-0.7 * 0.25 * 0.25) - 0.5 * std::exp(-0.7 * (0.5 * 0.5 + 1.25 * 1.25));
  constexpr double kSinglePrecision = 1e-6;
  EXPECT_NEAR(kernel_score(kernel, features), expected, kSinglePrecision);
}

TEST(KernelScore, TakesTheFeaturesThemselvesWithoutAProjection) {
  KernelStage kernel;
  kernel.mean = {1.0F, 0.0F};
  kernel.support_vectors = {1, 2, {0.0F, 0.5F}};
  kernel.coefficients = {1.0F};
  EXPECT_NEAR(kernel_score(kernel, std::vector<float>{2.0F, 0.5F}), std::exp(-1.0), 1e-7);
}

TEST(PersonProbability, RisesWithTheLinearScoreOnBothSidesOfTheStep) {
  PeopleModel model;
  model.linear.weights.assign(feature_count(model.hog), 0.0F);
  model.linear.weights[0] = 1.0F;
  model.linear.reject_below = 0.5;
  model.kernel.emplace();
  model.kernel->mean.assign(feature_count(model.hog), 0.0F);
  model.kernel->bias = -9.0;  // the second stage likes nothing, and still ranks before what was rejected
  std::vector<float> features(feature_count(model.hog), 0.0F);
  double last = 0.0;
  for (const float score : {0.0F, 0.25F, 0.499F, 0.5F}) {
    features[0] = score;
    EXPECT_GT(person_probability(model, features), last);
    last = person_probability(model, features);
    EXPECT_EQ(last >= kRejectedProbability, score >= 0.5F);
  }
}

TEST(PersonProbability, LetsTheLinearMachineHaveItsSayBesideConvolutions) {
  PeopleModel model;
  model.linear.reject_below = -1.0;
  model.convolution.emplace();
  model.convolution->linear_weight = 0.5;
  model.convolution->calibration = {2.0, 0.25};
  const double last = 1.0 / (1.0 + std::exp(-(2.0 * (1.5 + 0.5 * 0.75) + 0.25)));
  EXPECT_NEAR(person_probability(model, 0.75, 1.5), kRejectedProbability + (1.0 - kRejectedProbability) * last, 1e-12);
  EXPECT_LT(person_probability(model, -1.1, 100.0), kRejectedProbability);
}

TEST(PeopleModel, HasANetworkThatComesWithTheLibrary) {
  const PeopleModel model = people_model("flies-48x96-network");
  ASSERT_TRUE(model.convolution.has_value());
  EXPECT_FALSE(model.kernel.has_value());
  EXPECT_GT(model.convolution->layers.size(), 1U);
}

}  // namespace
}  // namespace flies
