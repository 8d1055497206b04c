#include <gtest/gtest.h>

#include "flies/classify/people_classifier.hpp"
#include "flies/pipeline/detector.hpp"

namespace flies {
namespace {

TEST(PresetPeopleModel, IsWhatThePresetsClassifierIsMadeOf) {
  EXPECT_EQ(preset_people_model(Preset::paper), "flies-48x96-linear");
  EXPECT_EQ(preset_people_model(Preset::robot), "flies-48x96-network");
}

TEST(PresetClassifier, IsTheLinearMachineForThePaper) {
  EXPECT_FALSE(preset_classifier(Preset::paper)->looks_twice());
  EXPECT_TRUE(preset_classifier(Preset::standard)->looks_twice());
  EXPECT_EQ(preset_classifier(Preset::standard), default_people_classifier());
}

}  // namespace
}  // namespace flies
