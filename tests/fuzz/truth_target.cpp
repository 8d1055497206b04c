#include <array>
#include <cmath>
#include <functional>

#include "flies/core/error.hpp"
#include "flies/eval/detections.hpp"
#include "flies/eval/foot_truth.hpp"
#include "flies/eval/kitti_truth.hpp"
#include "flies/eval/scene_truth.hpp"
#include "flies/io/writers.hpp"
#include "flies/synth/truth.hpp"
#include "flies/train/coco_labels.hpp"
#include "flies/train/picture_labels.hpp"
#include "flies/train/yolo_labels.hpp"
#include "tests/fuzz/target.hpp"

namespace {

const flies::StereoCamera kCamera{700, 700, 600, 600, 170, 0.5, 1242, 375, {}};

}  // namespace

// Everything that evaluation and training read as text: each input goes to all of them.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::array<std::function<void()>, 12> readers = {
      [&] { flies::parse_labels(text, "input"); },
      [&] { flies::parse_tracklets(text, "input"); },
      [&] { flies::parse_scene_truth(text, "input"); },
      [&] { flies::parse_detections(text, "input"); },
      [&] { flies::parse_voc_labels(text, "input"); },
      [&] { flies::parse_kitti_boxes(text, "input"); },
      [&] { flies::parse_foot_points(text, "input", kCamera); },
      [&] { flies::parse_pascal_text(text, "input"); },
      [&] { flies::parse_coco_labels(text, "input"); },
      [&] {
        flies::YoloLines lines;
        lines.add(text);
        flies::parse_yolo_labels(text, "input", {}, lines, kCamera.width_px, kCamera.height_px);
      },
      [&] { flies::parse_yolo_names(text, "input"); },
      [&] { flies::parse_yolo_yaml(text, "input"); }};
  for (const auto& read : readers) {
    try {
      read();
    } catch (const flies::InputError&) {
    }
  }
  return 0;
}

namespace {

/// What `flies detect` writes of a pair.
std::string detection_line() {
  flies::FrameRecord record;
  record.left = "a.png";
  auto& obstacle = record.obstacles.emplace_back();
  obstacle.x_m = 8;
  obstacle.y_m = 6;
  obstacle.range_m = 10;
  obstacle.box = {1, 2, 30, 60};
  auto& person = record.pedestrians.emplace_back();
  person.x_m = 8;
  person.y_m = 6;
  person.probability = 0.9;
  person.box = obstacle.box;
  record.scan = {-0.01, 0.01, {9, std::nan(""), std::nan("")}, {9, 20, 0}, {1, 0.5, 0}, {}};
  record.scan.states = {flies::SectorState::obstacle, flies::SectorState::free, flies::SectorState::unknown};
  return flies::json_line(record);
}

/// What `flies synth` writes of a picture.
std::vector<flies::TruthObject> scene_objects() {
  flies::TruthObject person;
  person.x_m = person.near_range_m = 9;
  person.length_m = person.width_m = 0.6;
  person.height_m = 1.8;
  person.whole_box = person.box = {500, 100, 60, 140};
  person.visible_px = 5000;
  return {person};
}

}  // namespace

std::vector<std::string> fuzz_seeds() {
  return {
      "Pedestrian 0.00 0 -0.20 712 143 810 307 1.89 0.48 1.20 1.84 1.47 8.41 0.01\n"
      "DontCare -1 -1 -10 503.89 169.71 590.61 190.13 -1 -1 -1 -1000 -1000 -1000 -10\n",
      "<boost_serialization><tracklets><item><objectType>Car</objectType><h>1</h><w>1</w><l>4</l><first_frame>0"
      "</first_frame><poses><item><tx>15</tx><ty>2</ty><tz>-1</tz><rz>1</rz><occlusion>0</occlusion><truncation>0"
      "</truncation></item></poses></item></tracklets></boost_serialization>",
      R"({"objects": [{"class": "car", "x_m": 12, "y_m": 1, "length_m": 4, "width_m": 2, "height_m": 1.5}]})",
      R"({"frame": 1, "left": "a.png", "obstacles": [{"x_m": 8, "y_m": 6}], "pedestrians": [{"x_m": 8, "y_m": 6,)"
      R"( "score": 0.5, "box": {"u_px": 1, "v_px": 2, "width_px": 3, "height_px": 4}}], "stage_ms": {"road": 1}})",
      "<annotation><filename>a.png</filename><object><name>person</name><bndbox><xmin>10</xmin><ymin>20</ymin>"
      "<xmax>40</xmax><ymax>120</ymax></bndbox></object></annotation>",
      "0 0.5 0.5 0.2 0.4 # a box\n0 0.1 0.2 0.3 0.2 0.3 0.8 0.1 0.8\n1 0.5 0.5 0.2 0.4\n0 0.0 0.5 0.2 0.4\n",
      "car\r\nPerson\r\n",
      "nc: 2\nnames: ['car', 'Person']\n",
      "names:\n  0: car\n  5: person\n",
      detection_line(),
      flies::truth_json(scene_objects(), kCamera, 3, flies::TruthMoment{0.1, {1, 2, 0.1}}),
      flies::kitti_labels(scene_objects(), kCamera),
      "# header\n2,7,10,20,30,140,1,-1.0,0.9,8.75\n"};
}
