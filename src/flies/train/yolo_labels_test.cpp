#include "flies/train/yolo_labels.hpp"

#include <gmock/gmock.h>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(ParseYoloLabels, ReadsBoxesAndPolygons) {
  const PictureLabels labels = parse_yolo_labels(
      "0 0.5 0.5 0.2 0.4 # a box\n\n0 0.1 0.2 0.3 0.2 0.3 0.8 0.1 0.8\n1 0.5 0.5 0.2 0.4\n"
      "0 0.0 0.5 0.2 0.4\n",
      "a.txt", {}, {}, 100, 200);
  ASSERT_THAT(labels.people, SizeIs(2));
  EXPECT_DOUBLE_EQ(labels.people[0].u_px, 40.0);
  EXPECT_DOUBLE_EQ(labels.people[0].v_px, 60.0);
  EXPECT_DOUBLE_EQ(labels.people[0].width_px, 20.0);
  EXPECT_DOUBLE_EQ(labels.people[0].height_px, 80.0);
  EXPECT_DOUBLE_EQ(labels.people[1].u_px, 10.0);
  EXPECT_DOUBLE_EQ(labels.people[1].height_px, 120.0);
  EXPECT_THAT(labels.unclear, SizeIs(1));  // half of it is outside
}

TEST(ParseYoloLabels, NamesTheLine) {
  const auto fault = [](const char* text) {
    return testing::error_of([&] { parse_yolo_labels(text, "a.txt", {}, {}, 100, 200); });
  };
  EXPECT_THAT(fault("0 0.5 0.5 0.2 0.4\n0 0.5 0.5"), HasSubstr("a.txt: line 2: found 3 fields"));
  EXPECT_THAT(fault("0 64 0.5 0.2 0.4"), HasSubstr("found 64, expected shares"));
  EXPECT_THAT(fault("0 0.5 0.5 0 0.4"), HasSubstr("left < right"));
  EXPECT_THAT(fault("person 0.5 0.5 0.1 0.4"), HasSubstr("line 1"));
  EXPECT_THAT(parse_yolo_names("car\r\nPerson\r\n", "classes.txt").people, ElementsAre(1));
  EXPECT_THAT(testing::error_of([] { parse_yolo_names("car\n", "classes.txt"); }), HasSubstr("names no person"));
}

/// Of a set of one file.
PictureLabels parse_set(const std::string& text, const YoloClasses& classes = {}) {
  YoloLines lines;
  lines.add(text);
  return parse_yolo_labels(text, "a.txt", classes, lines, 100, 200);
}

constexpr const char* kBoxLine = "0 0.5 0.5 0.2 0.4";

/// Whether the lines are read as the box of `kBoxLine`.
void expect_boxes(const std::string& behind, const YoloClasses& classes = {}) {
  const PictureLabels labels = parse_set(kBoxLine + behind, classes);
  ASSERT_THAT(labels.people, SizeIs(1)) << behind;
  EXPECT_DOUBLE_EQ(labels.people[0].u_px, 40.0) << behind;
  EXPECT_DOUBLE_EQ(labels.people[0].v_px, 60.0) << behind;
  EXPECT_DOUBLE_EQ(labels.people[0].width_px, 20.0) << behind;
  EXPECT_DOUBLE_EQ(labels.people[0].height_px, 80.0) << behind;
}

TEST(ParseYoloLabels, PassesConfidenceTrackAndKeypointsOver) {
  expect_boxes(" 0.87");
  expect_boxes(" 3");
  expect_boxes(" 0.87 3");
  expect_boxes(" 0.87 1");
  expect_boxes(" 0.45 0.4 2");
  expect_boxes(" 0.45 0.4 0.9");
  expect_boxes(" 0.45 0.4 1 0.55 0.4 2");
  for (const char* more : {"", " 0.87", " 0.87 3"})
    expect_boxes(std::string(" 0.45 0.4 0.9 0.55 0.4 0.8") + more,
                 {.people = {0}, .unclear = {}, .keypoint_numbers = 6});
}

TEST(ParseYoloLabels, AsksTheWholeSetWhatFollowsABox) {
  YoloLines lines;
  lines.add("0 0.5 0.5 0.2 0.4 0.9 12\n0 0.2 0.5 0.1 0.4 0.8 1\n");
  EXPECT_TRUE(lines.are_boxes(7));
  EXPECT_FALSE(lines.are_boxes(9));
  const auto labels = parse_yolo_labels("0 0.2 0.5 0.1 0.4 0.8 1", "a.txt", {}, lines, 100, 200);
  ASSERT_THAT(labels.people, SizeIs(1));
  EXPECT_DOUBLE_EQ(labels.people[0].height_px, 80.0);
}

TEST(ParseYoloLabels, KeepsPolygons) {
  const PictureLabels labels =
      parse_set("0 0.1 0.2 0.3 0.2 0.2 0.8\n0 0.1 0.2 0.3 0.2 0.3 0.9 0.1 0.9\n0 0.5 0.5 0.6 0.5 0.6 1\n");
  ASSERT_THAT(labels.people, SizeIs(3));
  EXPECT_DOUBLE_EQ(labels.people[0].height_px, 120.0);
  EXPECT_DOUBLE_EQ(labels.people[1].height_px, 140.0);
  EXPECT_DOUBLE_EQ(labels.people[2].height_px, 100.0);
}

TEST(ParseYoloLabels, RefusesWhatFollowsWithoutMeaning) {
  const auto fault = [](const std::string& behind) { return testing::error_of([&] { parse_set(kBoxLine + behind); }); };
  EXPECT_THAT(fault(" 1.5"), HasSubstr("line 1: found 6 fields"));
  EXPECT_THAT(fault(" x"), HasSubstr("found 6 fields"));
  EXPECT_THAT(fault(" 0.1 0.2 64"), HasSubstr("found 8 fields"));
  EXPECT_THAT(fault(" 64 0.5"), HasSubstr("found 64, expected shares"));
}

TEST(ParseYoloLabels, LearnsFromAllClassesOfPeopleAndFromNoRiders) {
  const auto classes = parse_yolo_yaml("names: [pedestrian, car, person, rider, people]\n", "data.yaml");
  ASSERT_TRUE(classes);
  EXPECT_THAT(classes->people, ElementsAre(0, 2));
  EXPECT_THAT(classes->unclear, ElementsAre(3, 4));
  const PictureLabels labels = parse_set(
      "0 0.5 0.5 0.2 0.4\n1 0.5 0.5 0.2 0.4\n2 0.5 0.5 0.2 0.4\n3 0.5 0.5 0.2 0.4\n4 0.5 0.5 0.2 0.4\n", *classes);
  EXPECT_THAT(labels.people, SizeIs(2));
  EXPECT_THAT(labels.unclear, SizeIs(2));
  const YoloClasses names = parse_yolo_names("person\nPerson\nCyclist\n", "classes.txt");
  EXPECT_THAT(names.people, ElementsAre(0, 1));
  EXPECT_THAT(names.unclear, ElementsAre(2));
  EXPECT_THAT(parse_yolo_names("person\n", "classes.txt").unclear, IsEmpty());
}

TEST(ParseYoloYaml, KnowsListsAndMaps) {
  const auto people = [](const char* text) { return parse_yolo_yaml(text, "data.yaml")->people; };
  EXPECT_THAT(people("nc: 2\nnames: ['car', 'Person']\n"), ElementsAre(1));
  EXPECT_THAT(people("names:\n  - pedestrian\n  - car\n"), ElementsAre(0));
  EXPECT_THAT(people("names:\n  0: car\n  5: person\n"), ElementsAre(5));
  EXPECT_FALSE(parse_yolo_yaml("path: .\n", "other.yaml"));
  EXPECT_THAT(testing::error_of([] { parse_yolo_yaml("names: [car]\n", "data.yaml"); }),
              HasSubstr("data.yaml: names: holds no person"));
  EXPECT_THAT(testing::error_of([] { parse_yolo_yaml("names: [people]\n", "data.yaml"); }),
              HasSubstr("where each of its boxes is one person, call it person"));
}

TEST(ParseYoloYaml, TakesTheShapeOfKeypoints) {
  EXPECT_EQ(parse_yolo_yaml("names: [person]\nkpt_shape: [17, 3]\n", "data.yaml")->keypoint_numbers, 51);
  EXPECT_EQ(parse_yolo_yaml("names: [person]\n", "data.yaml")->keypoint_numbers, 0);
  for (const char* shape : {"17", "[17]", "[0, 3]", "[17, 4]", "[[1], 2]"})
    EXPECT_THAT(testing::error_of(
                    [&] { parse_yolo_yaml(std::string("names: [person]\nkpt_shape: ") + shape + "\n", "data.yaml"); }),
                HasSubstr("data.yaml: kpt_shape"))
        << shape;
}

}  // namespace
}  // namespace flies
