#include "flies/train/picture_labels.hpp"

#include <gmock/gmock.h>

#include "flies/io/temporary_folder.hpp"
#include "flies/train/yolo_labels.hpp"

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

TEST(ParseVocLabels, PutsCyclistsSittingPeopleAndFlagsInWordsAside) {
  const auto with = [](const std::string& name, const std::string& flags) {
    return parse_voc_labels("<annotation><object><name>" + name + "</name>" + flags +
                                "<bndbox><xmin>1</xmin><ymin>2</ymin><xmax>3</xmax><ymax>9</ymax></bndbox></object>"
                                "</annotation>",
                            "a.xml");
  };
  for (const char* name : {"Cyclist", "Person_sitting", "rider", "people", "DontCare"}) {
    EXPECT_THAT(with(name, "").people, SizeIs(0)) << name;
    EXPECT_THAT(with(name, "").unclear, SizeIs(1)) << name;
  }
  for (const char* flag : {"<truncated>True</truncated>", "<difficult>true</difficult>", "<occluded>1</occluded>",
                           "<truncated>0.5</truncated>"})
    EXPECT_THAT(with("person", flag).unclear, SizeIs(1)) << flag;
  for (const char* flag : {"<truncated>False</truncated>", "<difficult>Unspecified</difficult>",
                           "<occluded>0</occluded>", "<truncated>0.05</truncated>"})
    EXPECT_THAT(with("person", flag).people, SizeIs(1)) << flag;
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

TEST(ParseKittiBoxes, TakesNamesInSmallLetters) {
  const std::string rest = " 0.00 0 -0.2 10 20 30 90 1.89 0.48 1.20 1.84 1.47 8.41 0.01\n";
  const PictureLabels labels = parse_kitti_boxes(
      "pedestrian" + rest + "cyclist" + rest + "person_sitting" + rest + "dontcare" + rest + "car" + rest, "1.txt");
  EXPECT_THAT(labels.people, SizeIs(1));
  EXPECT_THAT(labels.unclear, SizeIs(3));
}

TEST(ParseKittiBoxes, NamesTheLine) {
  EXPECT_THAT(testing::error_of([] { parse_kitti_boxes("\nPedestrian 0 0", "1.txt"); }),
              HasSubstr("1.txt: line 2: found 3"));
  EXPECT_THAT(testing::error_of([] { parse_kitti_boxes("Pedestrian 0 0 0 30 20 10 90 1 1 1 1 1 1 1", "1.txt"); }),
              HasSubstr("left < right"));
}

constexpr const char* kPascal = R"(# PASCAL Annotation Version 1.00

Image filename : "Train/pos/a.png"
Image size (X x Y x C) : 1124 x 826 x 3
Objects with ground truth : 3 { "PASperson" "PASperson" "PASmotorbike" }
# Top left pixel co-ordinates : (0, 0)
Original label for object 1 "PASperson" : "UprightPerson"
Center point on object 1 "PASperson" (X, Y) : (344, 235)
Bounding box for object 1 "PASperson" (Xmin, Ymin) - (Xmax, Ymax) : (164, 176) - (433, 784)
Bounding box for object 2 "PASpersonSitting" (Xmin, Ymin) - (Xmax, Ymax) : (530, 167) - (760, 773)
Bounding box for object 3 "PASmotorbike" (Xmin, Ymin) - (Xmax, Ymax) : (1, 2) - (3, 4)
)";

TEST(ParsePascalText, ReadsPeopleAndTheSize) {
  const PictureLabels labels = parse_pascal_text(kPascal, "a.txt");
  EXPECT_EQ(labels.picture, "Train/pos/a.png");
  EXPECT_EQ(labels.width_px, 1124);
  EXPECT_EQ(labels.height_px, 826);
  ASSERT_THAT(labels.people, SizeIs(1));
  EXPECT_EQ(labels.people[0].u_px, 164.0);
  EXPECT_EQ(labels.people[0].v_px, 176.0);
  EXPECT_EQ(labels.people[0].width_px, 269.0);
  EXPECT_EQ(labels.people[0].height_px, 608.0);
  EXPECT_THAT(labels.unclear, SizeIs(1));
  EXPECT_TRUE(is_pascal_text(kPascal));
  EXPECT_FALSE(is_pascal_text("0 0.5 0.5 0.1 0.3"));
}

TEST(ParsePascalText, NamesTheLine) {
  const std::string start = "# PASCAL Annotation Version 1.00\nBounding box for object 1 \"PASperson\" : ";
  EXPECT_THAT(testing::error_of([&] { parse_pascal_text(start + "(1, 2) - (3", "a.txt"); }),
              HasSubstr("a.txt: line 2: found 3 numbers"));
  EXPECT_THAT(testing::error_of([&] { parse_pascal_text(start + "(5, 2) - (3, 4)", "a.txt"); }),
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

/// What a set of so many pictures with these labels of YOLO is refused with.
std::string complaint_of(const std::vector<std::string>& texts, int pictures) {
  return testing::error_of([&] {
    PeopleCheck check;
    for (int i = 0; i < pictures; ++i)
      for (const auto& text : texts)
        check.add(parse_yolo_labels(text, "", {}, {}, 640, 480), "labels/" + text + ".txt");
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

}  // namespace
}  // namespace flies
