#include "flies/train/training_picture.hpp"

#include <gmock/gmock.h>

#include <fstream>

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
