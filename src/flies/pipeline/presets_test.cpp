#include <gtest/gtest.h>

#include "flies/classify/people_classifier.hpp"
#include "flies/pipeline/detector.hpp"

namespace flies {
namespace {

TEST(PresetClassifier, IsTheLinearMachineForThePaper) {
  EXPECT_EQ(preset_classifier(Preset::paper)->name(), "flies-48x96-linear");
  EXPECT_EQ(preset_classifier(Preset::standard), default_people_classifier());
}

}  // namespace
}  // namespace flies
