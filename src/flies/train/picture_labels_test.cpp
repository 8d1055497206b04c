#include "flies/train/picture_labels.hpp"

#include <gmock/gmock.h>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr const char* kVoc = R"(<annotation><filename>a.png</filename>
<object><name>person</name><bndbox><xmin>10</xmin><ymin>20</ymin><xmax>40</xmax><ymax>120</ymax></bndbox></object>
<object><name>person</name><difficult>1</difficult><bndbox><xmin>1</xmin><ymin>2</ymin><xmax>3</xmax><ymax>4</ymax></bndbox></object>
<object><name>car</name><bndbox><xmin>1</xmin><ymin>2</ymin><xmax>3</xmax><ymax>4</ymax></bndbox></object>
</annotation>)";

TEST(ParseVocLabels, TakesPeopleAndPutsDifficultOnesAside) {
  const PictureLabels labels = parse_voc_labels(kVoc, "a.xml");
  EXPECT_EQ(labels.picture, "a.png");
  ASSERT_THAT(labels.people, SizeIs(1));
  EXPECT_EQ(labels.people[0].u_px, 10.0);
  EXPECT_EQ(labels.people[0].v_px, 20.0);
  EXPECT_EQ(labels.people[0].width_px, 30.0);
  EXPECT_EQ(labels.people[0].height_px, 100.0);
  EXPECT_THAT(labels.unclear, SizeIs(1));
}

TEST(ParseVocLabels, NamesTheObjectAndTheCoordinate) {
  const std::string bad =
      "<annotation><object><name>person</name><bndbox><xmin>x</xmin></bndbox></object></annotation>";
  EXPECT_THAT(testing::error_of([&] { parse_voc_labels(bad, "a.xml"); }), HasSubstr("a.xml: object 1.bndbox.xmin"));
  EXPECT_THAT(testing::error_of([&] { parse_voc_labels("<annotation>", "a.xml"); }), HasSubstr("a.xml: byte"));
  EXPECT_THAT(testing::error_of([&] { parse_voc_labels("<xml/>", "a.xml"); }), HasSubstr("annotation"));
}

TEST(ParseKittiBoxes, SortsByTypeOcclusionAndTruncation) {
  const PictureLabels labels = parse_kitti_boxes(
      "Pedestrian 0.00 0 -0.2 712.40 143.00 810.73 307.92 1.89 0.48 1.20 1.84 1.47 8.41 0.01\n"
      "Pedestrian 0.00 2 -0.2 10 20 30 90 1.89 0.48 1.20 1.84 1.47 8.41 0.01\n"
      "Pedestrian 0.50 0 -0.2 10 20 30 90 1.89 0.48 1.20 1.84 1.47 8.41 0.01\n"
      "Cyclist 0.00 0 -0.2 10 20 30 90 1.89 0.48 1.20 1.84 1.47 8.41 0.01\n"
      "Car 0.00 0 -0.2 10 20 30 90 1.89 0.48 1.20 1.84 1.47 8.41 0.01\n"
      "DontCare -1 -1 -10 503.89 169.71 590.61 190.13 -1 -1 -1 -1000 -1000 -1000 -10\n",
      "1.txt");
  ASSERT_THAT(labels.people, SizeIs(1));
  EXPECT_DOUBLE_EQ(labels.people[0].height_px, 307.92 - 143.0);
  EXPECT_THAT(labels.unclear, SizeIs(4));
}

TEST(ParseKittiBoxes, NamesTheLine) {
  EXPECT_THAT(testing::error_of([] { parse_kitti_boxes("\nPedestrian 0 0", "1.txt"); }),
              HasSubstr("1.txt: line 2: found 3"));
  EXPECT_THAT(testing::error_of([] { parse_kitti_boxes("Pedestrian 0 0 0 30 20 10 90 1 1 1 1 1 1 1", "1.txt"); }),
              HasSubstr("left < right"));
}

TEST(ParseVocLabels, TakesNamesInCapitalsAndTheSize) {
  const PictureLabels labels = parse_voc_labels(
      "<annotation><size><width>640</width><height>480</height></size><object><name>Person</name><bndbox><xmin>1</xmin>"
      "<ymin>2</ymin><xmax>3</xmax><ymax>9</ymax></bndbox></object></annotation>",
      "a.xml");
  EXPECT_THAT(labels.people, SizeIs(1));
  EXPECT_EQ(labels.width_px, 640);
  EXPECT_EQ(labels.height_px, 480);
}

TEST(ParseYoloLabels, ReadsBoxesAndPolygons) {
  const PictureLabels labels = parse_yolo_labels(
      "0 0.5 0.5 0.2 0.4 # a box\n\n0 0.1 0.2 0.3 0.2 0.3 0.8 0.1 0.8\n1 0.5 0.5 0.2 0.4\n"
      "0 0.0 0.5 0.2 0.4\n",
      "a.txt", 0, 100, 200);
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
    return testing::error_of([&] { parse_yolo_labels(text, "a.txt", 0, 100, 200); });
  };
  EXPECT_THAT(fault("0 0.5 0.5 0.2 0.4\n0 0.5 0.5"), HasSubstr("a.txt: line 2: found 3 fields"));
  EXPECT_THAT(fault("0 64 0.5 0.2 0.4"), HasSubstr("found 64, expected shares"));
  EXPECT_THAT(fault("0 0.5 0.5 0 0.4"), HasSubstr("left < right"));
  EXPECT_THAT(fault("person 0.5 0.5 0.1 0.4"), HasSubstr("line 1"));
  EXPECT_EQ(parse_yolo_names("car\r\nPerson\r\n", "classes.txt"), 1);
  EXPECT_THAT(testing::error_of([] { parse_yolo_names("car\n", "classes.txt"); }), HasSubstr("names no person"));
}

/// What a set of so many pictures with these labels of YOLO is refused with.
std::string complaint_of(const std::vector<std::string>& texts, int pictures) {
  return testing::error_of([&] {
    PeopleCheck check;
    for (int i = 0; i < pictures; ++i)
      for (const auto& text : texts) check.add(parse_yolo_labels(text, "", 0, 640, 480), "labels/" + text + ".txt");
    check.finish();
  });
}

TEST(PeopleCheck, RefusesCornersForMiddleAndSize) {
  // Upright people, the one at the left of the picture upright by either reading.
  const std::vector<std::string> corners = {"0 0.1 0.3 0.175 0.6", "0 0.3188 0.3 0.3938 0.6",
                                            "0 0.5375 0.3 0.6125 0.6"};
  EXPECT_THAT(complaint_of(corners, 4), AllOf(HasSubstr("labels/0 0.5375"), HasSubstr("of 12 boxes of the set 4 are"),
                                              HasSubstr("12 stand upright"), HasSubstr("YOLO's middle, width")));
  EXPECT_EQ(complaint_of(corners, 3), "no error") << "too few to tell";
  EXPECT_THAT(complaint_of({"0 0.8 0.3 0.9 0.7"}, 10), HasSubstr("leave the picture"));
}

TEST(PeopleCheck, RefusesPeopleWhoAreWiderThanTall) {
  EXPECT_THAT(complaint_of({"0 0.45 0.1375 0.3 0.075", "0 0.45 0.45 0.1 0.4", "0 0.45 0.575 0.3 0.075"}, 4),
              AllOf(HasSubstr("labels/0 0.45 0.1375"), HasSubstr("of 12 people of the set 8 are wider than tall"),
                    HasSubstr("exchanged")));
  PeopleCheck check;
  const auto exchanged = parse_voc_labels(
      "<annotation><object><name>person</name><bndbox><xmin>144</xmin><ymin>64</ymin><xmax>288</xmax><ymax>112</ymax>"
      "</bndbox></object></annotation>",
      "a.xml");
  for (int i = 0; i < 10; ++i) check.add(exchanged, "a.xml");
  EXPECT_THAT(testing::error_of([&] { check.finish(); }), HasSubstr("a.xml: of 10 people"));
}

TEST(PeopleCheck, PassesPeopleWhoStandFillThePictureOrLieNowAndThen) {
  EXPECT_EQ(complaint_of({"0 0.1375 0.45 0.075 0.3"}, 20), "no error");
  EXPECT_EQ(complaint_of({"0 0.5 0.5 0.6 0.95"}, 20), "no error") << "ordered as corners, too";
  EXPECT_EQ(complaint_of({"0 0.5 0.5 0.1 0.4", "0 0.5 0.5 0.4 0.1"}, 20), "no error");
  EXPECT_EQ(complaint_of({"1 0.5 0.5 0.4 0.1"}, 20), "no error") << "no people";
}

TEST(ParseYoloYaml, KnowsListsAndMaps) {
  EXPECT_EQ(parse_yolo_yaml("nc: 2\nnames: ['car', 'Person']\n", "data.yaml"), 1);
  EXPECT_EQ(parse_yolo_yaml("names:\n  - pedestrian\n  - car\n", "data.yaml"), 0);
  EXPECT_EQ(parse_yolo_yaml("names:\n  0: car\n  5: person\n", "data.yaml"), 5);
  EXPECT_FALSE(parse_yolo_yaml("path: .\n", "other.yaml"));
  EXPECT_THAT(testing::error_of([] { parse_yolo_yaml("names: [car]\n", "data.yaml"); }),
              HasSubstr("data.yaml: names: holds no person"));
}

}  // namespace
}  // namespace flies
