#include <gmock/gmock.h>

#include <fstream>

#include "flies/train/toy_pictures.hpp"
#include "flies/train/training_picture.hpp"

namespace flies {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Sets of labels of pictures that each test makes.
class LabelledPictures : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.file(name); }
  std::vector<std::string> set(const std::string& name) const { return {path(name)}; }

  void picture(const std::string& name) const {
    testing::write_picture(path(name), testing::toy_background(200, 160, 1));
  }
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    std::ofstream(path(name)) << text;
  }
  std::vector<TrainingPicture> people(const std::string& name) {
    notes_.clear();
    return find_pictures_of_people(set(name), 0.75, [&](const std::string& text) { notes_.push_back(text); });
  }
  /// Of a set given as people and as background, which are to be the same.
  std::string fault_of(const std::string& name) const {
    std::string fault = testing::error_of([&] { find_pictures_of_people(set(name), 0.75); });
    EXPECT_EQ(testing::error_of([&] { find_background(set(name)); }), fault);
    return fault;
  }

  std::vector<std::string> notes_;

 private:
  testing::TemporaryFolder folder_;
};

std::string voc(const std::string& filename, int top) {
  return "<annotation><filename>" + filename + "</filename><object><name>person</name><bndbox><xmin>10</xmin><ymin>" +
         std::to_string(top) + "</ymin><xmax>40</xmax><ymax>110</ymax></bndbox></object></annotation>";
}

TEST_F(LabelledPictures, KnowsFoldersInCapitals) {
  picture("s/Images/a.png");
  write("s/Labels/a.txt", "0 0.25 0.5 0.2 0.5\n");
  ASSERT_THAT(people("s"), SizeIs(1));
  EXPECT_FALSE(people("s")[0].is_crop);
  EXPECT_NEAR(people("s")[0].people[0].height_px, 80.0, 1e-9);
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(LabelledPictures, ReadsCoco) {
  picture("s/images/train/a.png");
  picture("s/images/train/b.png");
  write("s/annotations/instances.json",
        R"({"images": [{"id": 1, "file_name": "a.png"}], "categories": [{"id": 1, "name": "person"}],
            "annotations": [{"image_id": 1, "category_id": 1, "bbox": [10, 20, 40, 100]}]})");
  const auto found = people("s");
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].path, path("s/images/train/a.png"));
  EXPECT_EQ(found[0].people[0].height_px, 100.0);
  EXPECT_THAT(notes_,
              ElementsAre(AllOf(HasSubstr("1 of 2 pictures have no labels and are not used"), HasSubstr("b.png"))));
}

std::string coco(const std::string& file_name, const std::string& annotations) {
  return R"({"images": [{"id": 1, "file_name": ")" + file_name +
         R"("}], "categories": [{"id": 1, "name": "person"}], "annotations": [)" + annotations + "]}";
}

constexpr const char* kCocoPerson = R"({"id": 4, "image_id": 1, "category_id": 1, "bbox": [10, 20, 40, 100]})";

TEST_F(LabelledPictures, LearnsALabelThatIsThereTwiceOnce) {
  picture("s/images/a.png");
  write("s/a.json", coco("a.png", std::string(kCocoPerson) + "," + kCocoPerson +
                                      R"(,{"id": 5, "image_id": 1, "category_id": 1, "bbox": [11, 20, 40, 100]})"));
  ASSERT_THAT(people("s"), SizeIs(1));
  EXPECT_THAT(people("s")[0].people, SizeIs(2));
  EXPECT_THAT(notes_, ElementsAre(AllOf(HasSubstr("s: labels that repeat"), HasSubstr("left out: 1, the first in"),
                                        HasSubstr("a.png"))));
  picture("y/images/b.png");
  write("y/labels/b.txt", "0 0.25 0.5 0.2 0.5\n0 0.25 0.5 0.2 0.5\n");
  EXPECT_THAT(people("y")[0].people, SizeIs(1));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("labels that repeat")));
}

TEST_F(LabelledPictures, ReadsNamesOfWindowsInCoco) {
  picture("s/images/a.png");
  for (const char* name : {R"(images\\a.png)", R"(C:\\set\\images\\a.png)"}) {
    write("s/set.json", coco(name, kCocoPerson));
    ASSERT_THAT(people("s"), SizeIs(1)) << name;
    EXPECT_EQ(people("s")[0].path, path("s/images/a.png"));
  }
  write("s/set.json", coco(R"(images\\b.png)", kCocoPerson));
  EXPECT_THAT(fault_of("s"), HasSubstr(R"(found no picture 'images\b.png')"));
  picture(R"(w/images\a.png)");
  picture("w/a.png");
  write("w/set.json", coco(R"(images\\a.png)", kCocoPerson));
  EXPECT_EQ(people("w")[0].path, path(R"(w/images\a.png)"));
}

TEST_F(LabelledPictures, TellsOfListsOfYoloNamesThatContradictEachOther) {
  picture("s/images/a.png");
  write("s/labels/a.txt", "0 0.25 0.5 0.2 0.5\n1 0.25 0.5 0.2 0.4\n");
  write("s/data.yaml", "names: [person, bike]\n");
  write("s/classes.txt", "person\nbicycle\n");
  EXPECT_THAT(people("s"), SizeIs(1));
  EXPECT_THAT(notes_, IsEmpty());
  write("s/classes.txt", "car\nperson\n");
  EXPECT_NEAR(people("s")[0].people[0].height_px, 80.0, 1e-9);
  EXPECT_THAT(notes_,
              ElementsAre(AllOf(HasSubstr("classes.txt: by this list"), HasSubstr("data.yaml, which is used"))));
}

TEST_F(LabelledPictures, TellsOfYoloClassesWithoutAName) {
  picture("s/images/a.png");
  write("s/labels/a.txt", "0 0.25 0.5 0.2 0.5\n9 0.25 0.5 0.2 0.4\n");
  EXPECT_THAT(people("s"), SizeIs(1));
  EXPECT_THAT(notes_, IsEmpty());
  write("s/data.yaml", "names: {0: person, 9: ~}\n");
  EXPECT_THAT(people("s"), SizeIs(1));
  EXPECT_THAT(notes_, IsEmpty());
  write("s/data.yaml", "names: [person, bike]\n");
  EXPECT_THAT(people("s"), SizeIs(1));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("data.yaml: 1 of 2 labels are of classes without a name, 9 the first")));
}

TEST_F(LabelledPictures, ReadsTheTextOfTheInriaPeople) {
  picture("s/pos/a.png");
  write("s/annotations/a.txt",
        "# PASCAL Annotation Version 1.00\nImage filename : \"Train/pos/a.png\"\n"
        "Bounding box for object 1 \"PASperson\" (Xmin, Ymin) - (Xmax, Ymax) : (10, 20) - (40, 110)\n");
  const auto found = people("s");
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].people[0].v_px, 20.0);
  EXPECT_EQ(found[0].people[0].height_px, 90.0);
}

TEST_F(LabelledPictures, FindsKittiBelowTraining) {
  picture("s/training/image_2/7.png");
  write("s/training/label_2/7.txt", "Pedestrian 0 0 0 10 20 50 120 1 1 1 1 1 1 1\n");
  EXPECT_THAT(people("s"), SizeIs(1));
}

TEST_F(LabelledPictures, TellsOfPicturesWithoutLabels) {
  picture("voc/a.png");
  write("voc/a.xml", voc("a.png", 20));
  EXPECT_THAT(people("voc"), SizeIs(1));
  EXPECT_THAT(notes_, IsEmpty());
  picture("voc/b.png");
  std::vector<std::string> notes;
  EXPECT_THAT(find_background(set("voc"), [&](const std::string& text) { notes.push_back(text); }), SizeIs(1));
  EXPECT_THAT(notes, ElementsAre(AllOf(HasSubstr("voc: 1 of 2 pictures"), HasSubstr("b.png"))));
  picture("kitti/image_2/1.png");
  picture("kitti/image_2/2.png");
  write("kitti/label_2/1.txt", "Pedestrian 0 0 0 10 20 50 120 1 1 1 1 1 1 1\n");
  EXPECT_THAT(people("kitti"), SizeIs(1));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("2.png")));
}

TEST_F(LabelledPictures, RefusesOneFileNameInManyLabels) {
  picture("voc/a.png");
  picture("voc/b.png");
  write("voc/a.xml", voc("a.png", 20));
  write("voc/b.xml", voc("a.png", 50));
  EXPECT_THAT(fault_of("voc"), AllOf(HasSubstr("b.xml: filename: found 'a.png'"), HasSubstr("b.png has the name")));
  std::filesystem::remove(path("voc/b.png"));
  EXPECT_THAT(fault_of("voc"), AllOf(HasSubstr("b.xml: is for"), HasSubstr("a.png"), HasSubstr("a.xml")));
}

TEST_F(LabelledPictures, TakesRenamedPicturesWithTheirLabels) {
  picture("voc/a.png");
  picture("voc/b.png");
  write("voc/a.xml", voc("IMG_1.jpg", 20));
  write("voc/b.xml", voc("IMG_1.jpg", 50));
  const auto found = people("voc");
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].path, path("voc/a.png"));
  EXPECT_EQ(found[0].people[0].v_px, 20.0);
  EXPECT_EQ(found[1].path, path("voc/b.png"));
  EXPECT_EQ(found[1].people[0].v_px, 50.0);
}

TEST_F(LabelledPictures, RefusesLabelsThatItCannotRead) {
  picture("s/images/a.png");
  for (const char* name : {"labels.csv", "train.odgt", "a.json", "annotations/a.txt", "annotations/set00.vbb"}) {
    write(std::string("s/") + name, "{\"ID\": \"a\", \"gtboxes\": []}\n");
    EXPECT_THAT(fault_of("s"), HasSubstr(name)) << name;
    std::filesystem::remove(path(std::string("s/") + name));
    std::filesystem::remove(path("s/annotations"));
  }
  write("s/README.txt", "pictures of a street");
  EXPECT_THAT(find_background(set("s")), SizeIs(1));
}

TEST_F(LabelledPictures, RefusesFoldersOfLabelsWithoutAny) {
  picture("s/images/a.png");
  for (const char* name : {"labels", "Labels", "Annotations", "label_2"}) {
    std::filesystem::create_directories(path(std::string("s/") + name));
    EXPECT_THAT(fault_of("s"), AllOf(HasSubstr(name), HasSubstr("holds no"))) << name;
    std::filesystem::remove(path(std::string("s/") + name));
  }
}

TEST_F(LabelledPictures, RefusesCropsThatAreMostlyWide) {
  picture("s/a.png");
  picture("s/b.png");
  testing::write_picture(path("s/c.png"), testing::toy_background(64, 128, 1));
  EXPECT_THAT(testing::error_of([&] { people("s"); }),
              AllOf(HasSubstr("2 of 3 pictures are wider than high"), HasSubstr("a.png with 200 x 160 px")));
  EXPECT_THAT(find_background(set("s")), SizeIs(3));
  testing::write_picture(path("s/d.png"), testing::toy_background(64, 128, 1));
  EXPECT_THAT(people("s"), SizeIs(4));
}

}  // namespace
}  // namespace flies
