#include "flies/train/training_picture.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <utility>

#include "flies/train/toy_pictures.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

/// A place for pictures of one test.
class FindPeople : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.file(name); }

 private:
  testing::TemporaryFolder folder_;
};

std::string fault_of(const std::vector<std::string>& folders) {
  return testing::error_of([&] { find_pictures_of_people(folders, 0.75); });
}

TEST_F(FindPeople, TakesCropsOfAnySizeAsOnePersonInTheMiddle) {
  testing::write_picture(path("a/small.png"), testing::toy_background(30, 60, 1));
  const auto people = find_pictures_of_people(std::vector<std::string>{path("a")}, 0.5);
  ASSERT_THAT(people, SizeIs(1));
  ASSERT_THAT(people[0].people, SizeIs(1));
  EXPECT_EQ(people[0].people[0].v_px, 15.0);
  EXPECT_EQ(people[0].people[0].height_px, 30.0);
  const ImageBox window = window_around(people[0].people[0], 0.5);
  EXPECT_EQ(window.u_px, 0.0);
  EXPECT_EQ(window.v_px, 0.0);
  EXPECT_EQ(window.width_px, 30.0);
  EXPECT_EQ(window.height_px, 60.0);
}

TEST_F(FindPeople, ReadsLabelsBesideTheirPictures) {
  testing::write_picture(path("kitti/image_2/000001.png"), testing::toy_background(200, 160, 1));
  std::filesystem::create_directories(path("kitti/label_2"));
  std::ofstream(path("kitti/label_2/000001.txt")) << "Pedestrian 0 0 0 10 20 50 120 1 1 1 1 1 1 1\n";
  testing::write_picture(path("voc/b.png"), testing::toy_background(200, 160, 1));
  std::ofstream(path("voc/b.xml")) << "<annotation><object><name>person</name><bndbox><xmin>1</xmin><ymin>2</ymin>"
                                      "<xmax>31</xmax><ymax>92</ymax></bndbox></object></annotation>";
  const auto people = find_pictures_of_people(std::vector<std::string>{path("kitti"), path("voc")}, 0.75);
  ASSERT_THAT(people, SizeIs(2));
  EXPECT_EQ(people[0].people[0].height_px, 100.0);
  EXPECT_EQ(people[1].people[0].height_px, 90.0);
  EXPECT_EQ(people[1].path, path("voc/b.png"));
}

std::string voc(const std::string& name, const std::string& size, const std::string& box) {
  return "<annotation>" + size + "<object><name>" + name + "</name><bndbox>" + box + "</bndbox></object></annotation>";
}

constexpr const char* kBox = "<xmin>10</xmin><ymin>20</ymin><xmax>40</xmax><ymax>110</ymax>";

TEST_F(FindPeople, KeepsEqualNamesInTwoFoldersApart) {
  for (const auto& [day, top] : {std::pair("day1", "20"), std::pair("day2", "50")}) {
    testing::write_picture(path(std::string("voc/JPEGImages/") + day + "/a.png"), testing::toy_background(200, 160, 1));
    std::filesystem::create_directories(path(std::string("voc/Annotations/") + day));
    std::ofstream(path(std::string("voc/Annotations/") + day + "/a.xml"))
        << voc("Person", "", std::string("<xmin>10</xmin><ymin>") + top + "</ymin><xmax>40</xmax><ymax>110</ymax>");
  }
  const auto people = find_pictures_of_people(std::vector<std::string>{path("voc")}, 0.75);
  ASSERT_THAT(people, SizeIs(2));
  EXPECT_EQ(people[0].path, path("voc/JPEGImages/day1/a.png"));
  EXPECT_EQ(people[0].people[0].v_px, 20.0);
  EXPECT_EQ(people[1].path, path("voc/JPEGImages/day2/a.png"));
  EXPECT_EQ(people[1].people[0].v_px, 50.0);
  std::filesystem::rename(path("voc/Annotations/day1"), path("voc/Annotations/other"));
  EXPECT_THAT(fault_of({path("voc")}), ::testing::AllOf(HasSubstr("other/a.xml"), HasSubstr("have that name")));
}

TEST_F(FindPeople, RefusesLabelsOfAnotherSize) {
  testing::write_picture(path("voc/a.png"), testing::toy_background(200, 160, 1));
  std::ofstream(path("voc/a.xml")) << voc("person", "<size><width>400</width><height>320</height></size>", kBox);
  const auto people = find_pictures_of_people(std::vector<std::string>{path("voc")}, 0.75);
  EXPECT_THAT(testing::error_of([&] { load_picture(people[0]); }),
              ::testing::AllOf(HasSubstr("a.png: labels"), HasSubstr("400 x 320"), HasSubstr("200 x 160")));
}

TEST_F(FindPeople, TurnsBoxesThatAreOfTheStoredPicture) {
  // Seen, the picture is 160 x 200 px; it is stored on its side, and labelled as it is stored.
  const std::string jpeg = [] {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", testing::toy_background(200, 160, 1), bytes);
    return std::string(bytes.begin(), bytes.end());
  }();
  using namespace std::string_literals;
  const std::string exif =
      "\xFF\xE1\0\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"s;
  std::filesystem::create_directories(path("voc"));
  std::ofstream(path("voc/a.jpg"), std::ios::binary) << jpeg.substr(0, 2) << exif << jpeg.substr(2);
  std::ofstream(path("voc/a.xml")) << voc("person", "<size><width>200</width><height>160</height></size>",
                                          "<xmin>20</xmin><ymin>50</ymin><xmax>120</xmax><ymax>90</ymax>");
  const auto people = find_pictures_of_people(std::vector<std::string>{path("voc")}, 0.75);
  const GrayImage picture = load_picture(people[0]);
  EXPECT_EQ(picture.width_px, 160);
  EXPECT_EQ(picture.height_px, 200);
  const ImageBox& box = people[0].people[0];
  EXPECT_EQ(box.u_px, 160.0 - 90.0);  // a quarter clockwise: what was below is left
  EXPECT_EQ(box.v_px, 20.0);
  EXPECT_EQ(box.width_px, 40.0);
  EXPECT_EQ(box.height_px, 100.0);
}

TEST_F(FindPeople, ReadsYoloLabels) {
  for (const char* name : {"train/a.png", "train/b.png"})
    testing::write_picture(path(std::string("yolo/images/") + name), testing::toy_background(200, 160, 1));
  std::filesystem::create_directories(path("yolo/labels/train"));
  std::ofstream(path("yolo/labels/train/a.txt")) << "\xEF\xBB\xBF"
                                                    "0 0.25 0.5 0.2 0.5\r\n2 0.5 0.5 0.1 0.1\r\n";
  const std::vector<std::string> folder{path("yolo")};
  auto people = find_pictures_of_people(folder, 0.75);
  ASSERT_THAT(people, SizeIs(1));
  EXPECT_EQ(people[0].path, path("yolo/images/train/a.png"));
  ASSERT_THAT(people[0].people, SizeIs(1));
  EXPECT_NEAR(people[0].people[0].u_px, 30.0, 1e-9);
  EXPECT_NEAR(people[0].people[0].height_px, 80.0, 1e-9);
  EXPECT_FALSE(people[0].is_crop);
  EXPECT_THAT(find_background(folder), SizeIs(2));  // the one without labels shows nobody
  std::ofstream(path("yolo/classes.txt")) << "car\nbicycle\nPerson\n";
  people = find_pictures_of_people(folder, 0.75);
  ASSERT_THAT(people, SizeIs(1));
  EXPECT_NEAR(people[0].people[0].height_px, 16.0, 1e-9);
  std::filesystem::remove(path("yolo/classes.txt"));
  std::ofstream(path("yolo/data.yaml")) << "names: {0: bicycle, 2: person}\n";
  EXPECT_NEAR(find_pictures_of_people(folder, 0.75)[0].people[0].height_px, 16.0, 1e-9);
  std::ofstream(path("yolo/labels/train/c.txt")) << "0 0.25 0.5 0.2 0.5\n";
  EXPECT_THAT(fault_of(folder), HasSubstr("found no picture 'c'"));
}

TEST_F(FindPeople, PassesHiddenFilesAndFoldersOver) {
  testing::write_picture(path("a/1.png"), testing::toy_background(30, 60, 1));
  testing::write_picture(path("a/.git/2.png"), testing::toy_background(30, 60, 1));
  std::ofstream(path("a/._1.png")) << "no picture";
  std::ofstream(path("a/._1.xml")) << "no labels";
  EXPECT_THAT(find_pictures_of_people(std::vector<std::string>{path("a")}, 0.5), SizeIs(1));
}

TEST(CheckLabels, RefusesPeopleOutsideTheirPicture) {
  TrainingPicture picture;
  picture.path = "a.png";
  const auto fault = [&](const ImageBox& box) {
    picture.people = {{50, 20, 40, 100}, box};
    return testing::error_of([&] { check_labels(picture, 200, 160); });
  };
  EXPECT_EQ(fault({-5, -5, 40, 100}), "no error");
  for (const ImageBox& box : {ImageBox{5000, 20, 40, 100}, ImageBox{20, -300, 40, 100}, ImageBox{20, -900, 40, 2000}})
    EXPECT_THAT(fault(box), HasSubstr("a.png: labels: found a person at")) << box.u_px;
}

TEST_F(FindPeople, SaysWhatIsMissing) {
  std::filesystem::create_directories(path("empty"));
  EXPECT_THAT(fault_of({path("empty")}), HasSubstr("empty: found no pictures"));
  EXPECT_THAT(fault_of({path("none")}), HasSubstr("none: no such folder"));
  std::filesystem::create_directories(path("k/label_2"));
  std::ofstream(path("k/label_2/7.txt")) << "Pedestrian 0 0 0 10 20 50 120 1 1 1 1 1 1 1\n";
  std::filesystem::create_directories(path("k/image_2"));
  EXPECT_THAT(fault_of({path("k")}), HasSubstr("found no picture '7'"));
}

}  // namespace
}  // namespace flies
