#include <array>
#include <functional>

#include "flies/core/error.hpp"
#include "flies/eval/detections.hpp"
#include "flies/eval/foot_truth.hpp"
#include "flies/eval/kitti_truth.hpp"
#include "flies/eval/scene_truth.hpp"
#include "flies/train/picture_labels.hpp"
#include "tests/fuzz/target.hpp"

// Everything that evaluation and training read as text: each input goes to all of them.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const flies::StereoCamera camera{700, 700, 600, 600, 170, 0.5, 1242, 375, {}};
  const std::array<std::function<void()>, 7> readers = {[&] { flies::parse_labels(text, "input"); },
                                                        [&] { flies::parse_tracklets(text, "input"); },
                                                        [&] { flies::parse_scene_truth(text, "input"); },
                                                        [&] { flies::parse_detections(text, "input"); },
                                                        [&] { flies::parse_voc_labels(text, "input"); },
                                                        [&] { flies::parse_kitti_boxes(text, "input"); },
                                                        [&] { flies::parse_foot_points(text, "input", camera); }};
  for (const auto& read : readers) {
    try {
      read();
    } catch (const flies::InputError&) {
    }
  }
  return 0;
}

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
      "# header\n2,7,10,20,30,140,1,-1.0,0.9,8.75\n"};
}
