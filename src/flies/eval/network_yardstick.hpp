#pragma once

#include <memory>
#include <string>

#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/eval/people_boxes.hpp"

namespace flies {

/// How a network that looks at the whole left image is asked for people.
struct NetworkSearchOptions {
  int person_class = 0;
  double threshold = 0.25;
  double max_overlap = 0.5;
  int width_px = 0;
  int height_px = 0;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("person_class", self.person_class, Range{0, 10'000},
          "number of the network's class of people: 0 for COCO, 14 for VOC");
    field("threshold", self.threshold, Range{0.01, 0.99}, "people less certain than this are not reported");
    field("max_overlap", self.max_overlap, Range{0.0, 1.0},
          "of two detections whose intersection over union is larger, only the more certain one is kept");
    field("width_px", self.width_px, Range{0, 4096}, "width to resize the image to; 0: as the network's .cfg says");
    field("height_px", self.height_px, Range{0, 4096},
          "height to resize the image to, a multiple of 32 for most networks");
  }
};

/// A detector of the Darknet family (YOLO, Yolo-Fastest, ...) as a yardstick, run by OpenCV on the whole left image.
class NetworkSearch {
 public:
  /// @param weights_file NAME.weights; NAME.cfg, which says how the network is built, stands beside it
  /// @throws InputError naming the file that is missing or that OpenCV cannot read, or an option out of its range, such
  /// as a class that the network does not have
  explicit NetworkSearch(const std::string& weights_file, const NetworkSearchOptions& options = {});
  ~NetworkSearch();
  NetworkSearch(NetworkSearch&&) noexcept;

  /// @param least_probability of people that are reported, 0..1, as the network says: confidence times class
  /// @throws InputError when image and camera do not fit
  PeopleSearch detect(const GrayView& left, const StereoCamera& camera, double least_probability);

 private:
  struct Model;
  std::unique_ptr<Model> model_;
};

}  // namespace flies
