#include "flies/train/coco_labels.hpp"

#include <gmock/gmock.h>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

std::string coco(const std::string& annotations) {
  return R"({"images": [{"id": 7, "file_name": "a.jpg", "width": 640, "height": 480}, {"id": 8, "file_name": "b.jpg"}],
    "categories": [{"id": 1, "name": "person"}, {"id": 2, "name": "bicycle"}, {"id": 3, "name": "rider"}],
    "annotations": [)" +
         annotations + "]}";
}

std::string annotation(int image, int category, const std::string& box, const std::string& more = "") {
  return R"({"id": 1, "image_id": )" + std::to_string(image) + R"(, "category_id": )" + std::to_string(category) +
         R"(, "bbox": )" + box + more + "}";
}

TEST(ParseCocoLabels, SortsBoxesByImageAndCategory) {
  const std::string box = "[10, 20, 30.5, 90]";
  const auto pictures = parse_coco_labels(
      coco(annotation(7, 1, box) + "," + annotation(7, 2, box) + "," + annotation(7, 3, box) + "," +
           annotation(7, 1, box, R"(, "iscrowd": 1)") + "," +
           annotation(7, 1, box, R"(, "attributes": {"occluded": true})") + "," + annotation(7, 1, "[1, 2, 0, 5]")),
      "coco.json");
  ASSERT_THAT(pictures, SizeIs(2));
  EXPECT_EQ(pictures[0].picture, "a.jpg");
  EXPECT_EQ(pictures[0].width_px, 640);
  EXPECT_EQ(pictures[0].height_px, 480);
  ASSERT_THAT(pictures[0].people, SizeIs(1));
  EXPECT_EQ(pictures[0].people[0].u_px, 10.0);
  EXPECT_EQ(pictures[0].people[0].v_px, 20.0);
  EXPECT_EQ(pictures[0].people[0].width_px, 30.5);
  EXPECT_EQ(pictures[0].people[0].height_px, 90.0);
  EXPECT_THAT(pictures[0].unclear, SizeIs(3));
  EXPECT_EQ(pictures[1].picture, "b.jpg");
  EXPECT_EQ(pictures[1].width_px, 0);
  EXPECT_THAT(pictures[1].people, SizeIs(0));
}

TEST(ParseCocoLabels, NamesTheEntry) {
  const auto fault = [](const std::string& text) {
    return testing::error_of([&] { parse_coco_labels(text, "coco.json"); });
  };
  EXPECT_THAT(fault("{"), HasSubstr("coco.json: is no JSON"));
  EXPECT_THAT(fault("[]"), HasSubstr("not as COCO's labels are"));
  EXPECT_THAT(fault(R"({"shapes": [], "imagePath": "a.jpg"})"), HasSubstr("not as COCO's labels are"));
  EXPECT_THAT(fault(coco("3")), HasSubstr("annotations[0]: found number, expected an object"));
  EXPECT_THAT(fault(coco(annotation(9, 1, "[1, 2, 3, 4]"))), HasSubstr("annotations[0].image_id"));
  EXPECT_THAT(fault(coco(annotation(7, 9, "[1, 2, 3, 4]"))), HasSubstr("annotations[0].category_id"));
  EXPECT_THAT(fault(coco(annotation(7, 1, "[1, 2, 3]"))), HasSubstr("annotations[0].bbox"));
  EXPECT_THAT(fault(coco(annotation(7, 1, R"([1, 2, "3", 4])"))), HasSubstr("expected a number"));
  EXPECT_THAT(fault(coco(annotation(7, 1, "[1, 2, -3, 4]"))), HasSubstr("none below 0"));
}

}  // namespace
}  // namespace flies
