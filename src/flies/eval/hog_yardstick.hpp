#pragma once

#include <array>
#include <string_view>

#include "flies/classify/people_model.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/eval/people_boxes.hpp"

namespace flies {

/// Detectors of people that the verdicts are held against: OpenCV's, which look at the whole left image at all scales.
enum class HogDetector {
  hog_48x96,   ///< Daimler weights
  hog_64x128,  ///< INRIA weights
};
template <>
struct EnumNames<HogDetector> {
  static constexpr std::array<std::string_view, 2> names = {"hog-48x96", "hog-64x128"};
};

/// The settings of a careful user.
struct HogOptions {
  double enlarge = 1.0;
  double scale_step = 1.05;
  int stride_px = 8;
  double max_overlap = 0.5;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("enlarge", self.enlarge, Range{0.25, 8.0},
          "the image is resized by this factor first; above 1, people shorter than the window are found");
    field("scale_step", self.scale_step, Range{1.01, 2.0}, "ratio from one scale to the next");
    field("stride_px", self.stride_px, Range{8, 64}, "distance from one window to the next, a multiple of 8");
    field("max_overlap", self.max_overlap, Range{0.0, 1.0},
          "of two detections whose intersection over union is larger, only the more certain one is kept");
  }
};

/// Searches the whole left image by `cv::HOGDescriptor::detectMultiScale` and keeps the surest of overlapping verdicts;
/// OpenCV's own grouping would lose the scores.
/// @param least_probability of people that are reported, 0..1, by the calibration of `hog_model`
/// @throws InputError naming `hog.stride_px` when that is no multiple of 8, or when image and camera do not fit
PeopleSearch detect_people_by_hog(const GrayView& left, const StereoCamera& camera, HogDetector detector,
                                  double least_probability, const HogOptions& options = {});

/// The same weights as a model of boxes: its calibration and its threshold.
PeopleModel hog_model(HogDetector detector);

}  // namespace flies
