#include "flies/train/label_kind.hpp"

#include <gtest/gtest.h>

namespace flies {
namespace {

TEST(LabelKind, TakesPeopleByAnyUsualName) {
  for (const char* name : {"person", "Pedestrian", "PASperson", "PASpersonWalking", "pedestrians", "human"})
    EXPECT_EQ(label_kind(name), LabelKind::person) << name;
}

TEST(LabelKind, PutsWhoSitsRidesOrIsInACrowdAside) {
  for (const char* name :
       {"Person_sitting", "person_sitting", "Cyclist", "cyclist", "motorcyclist", "rider", "people", "crowd",
        "PASpersonSitting", "DontCare", "dontcare", "dont_care", "ignored regions", "person?", "person-group"})
    EXPECT_EQ(label_kind(name), LabelKind::unclear) << name;
}

TEST(LabelKind, LeavesTheRest) {
  for (const char* name : {"", "car", "Van", "bicycle", "Misc", "dog"})
    EXPECT_EQ(label_kind(name), LabelKind::other) << name;
}

}  // namespace
}  // namespace flies
