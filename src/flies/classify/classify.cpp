#include "flies/classify/classify.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

namespace flies {
namespace {

/// Pixels kept around the window after resizing, so that the gradients at its edge are real.
constexpr int kMargin_px = 1;
/// Below this there is nothing to see: resizing would invent all pixels.
constexpr double kMinWindow_px = 4.0;
/// Beyond this many times the image the window holds nothing but repeated border.
constexpr double kMaxWindowPerImage = 8.0;

cv::HOGDescriptor hog_of(const PeopleModel& model) {
  constexpr int kAperture = 1;
  constexpr double kSigmaFromBlock = -1.0;
  constexpr double kClip = 0.2;  // Dalal and Triggs' L2-Hys
  return cv::HOGDescriptor({model.window_width_px, model.window_height_px}, {model.block_px, model.block_px},
                           {model.stride_px, model.stride_px}, {model.cell_px, model.cell_px}, model.bins, kAperture,
                           kSigmaFromBlock, cv::HOGDescriptor::L2Hys, kClip, model.gamma);
}

bool worth_a_look(const ImageBox& box, const cv::Size& image) {
  const bool finite =
      std::isfinite(box.u_px) && std::isfinite(box.v_px) && std::isfinite(box.width_px) && std::isfinite(box.height_px);
  const bool sized = box.width_px >= kMinWindow_px / 2.0 && box.height_px >= kMinWindow_px &&
                     box.width_px <= kMaxWindowPerImage * image.width &&
                     box.height_px <= kMaxWindowPerImage * image.height;
  return finite && sized && box.u_px < image.width && box.v_px < image.height && box.u_px + box.width_px > 0.0 &&
         box.v_px + box.height_px > 0.0;
}

/// The box and its margin, resized so that the box has the model's size.
cv::Mat window_pixels(const cv::Mat& image, const ImageBox& box, const PeopleModel& model) {
  const double margin_u_px = kMargin_px * box.width_px / model.window_width_px;
  const double margin_v_px = kMargin_px * box.height_px / model.window_height_px;
  const int left = cvFloor(box.u_px - margin_u_px), right = cvCeil(box.u_px + box.width_px + margin_u_px);
  const int top = cvFloor(box.v_px - margin_v_px), bottom = cvCeil(box.v_px + box.height_px + margin_v_px);
  const cv::Rect wanted(left, top, right - left, bottom - top);
  const cv::Rect inside = wanted & cv::Rect({}, image.size());
  cv::Mat crop = image(inside);
  if (inside != wanted)
    cv::copyMakeBorder(image(inside), crop, inside.y - top, bottom - inside.br().y, inside.x - left,
                       right - inside.br().x, cv::BORDER_REPLICATE);
  cv::Mat pixels;
  cv::resize(crop, pixels, {model.window_width_px + 2 * kMargin_px, model.window_height_px + 2 * kMargin_px}, 0, 0,
             box.height_px > model.window_height_px ? cv::INTER_AREA : cv::INTER_LINEAR);
  return pixels;
}

double score_window(const cv::Mat& image, const ImageBox& box, const PeopleModel& model, const cv::HOGDescriptor& hog) {
  if (!worth_a_look(box, image.size())) return -std::numeric_limits<double>::infinity();
  std::vector<float> features;
  hog.compute(window_pixels(image, box, model), features, {}, {}, {{kMargin_px, kMargin_px}});
  return std::inner_product(features.begin(), features.end(), model.weights.begin(), model.bias);
}

/// Share of the smaller box that the other one covers.
double overlap(const ImageBox& a, const ImageBox& b) {
  const double width = std::min(a.u_px + a.width_px, b.u_px + b.width_px) - std::max(a.u_px, b.u_px);
  const double height = std::min(a.v_px + a.height_px, b.v_px + b.height_px) - std::max(a.v_px, b.v_px);
  if (width <= 0.0 || height <= 0.0) return 0.0;
  return width * height / std::min(a.width_px * a.height_px, b.width_px * b.height_px);
}

/// Whether the two verdicts speak of one person. Side by side people differ across the line of sight; in depth the
/// obstacles of one person scatter, so the radius grows with range, and boxes that cover the same part of the image
/// are one person at any range: nobody is seen through another.
bool same_person(const Pedestrian& a, const Pedestrian& b, const ClassifyOptions& options) {
  if (overlap(a.box, b.box) > options.max_overlap) return true;
  const double across_m =
      std::abs(std::atan2(a.y_m, a.x_m) - std::atan2(b.y_m, b.x_m)) * std::min(a.range_m, b.range_m);
  const double deep_m = std::abs(a.range_m - b.range_m);
  return across_m < options.lateral_radius_m && deep_m < options.depth_radius * std::max(a.range_m, b.range_m);
}

}  // namespace

std::vector<double> score_rois(const GrayView& left, std::span<const Roi> rois, const PeopleModel& model) {
  check_people_model(model, model.name.empty() ? "people model" : model.name);
  const cv::Mat image(left.height_px, left.width_px, CV_8UC1, const_cast<std::uint8_t*>(left.data),
                      static_cast<std::size_t>(left.stride));
  const cv::HOGDescriptor hog = hog_of(model);
  std::vector<double> scores(rois.size());
  tbb::parallel_for(std::size_t{0}, rois.size(),
                    [&](std::size_t i) { scores[i] = score_window(image, rois[i].window, model, hog); });
  return scores;
}

std::vector<Pedestrian> suppress_in_metres(std::span<const Roi> rois, std::span<const double> scores,
                                           const PeopleModel& model, const ClassifyOptions& options) {
  assert(rois.size() == scores.size());
  const double threshold = model.threshold + options.threshold_offset;
  std::vector<Pedestrian> verdicts;
  for (std::size_t i = 0; i < rois.size(); ++i)
    if (scores[i] > threshold)
      verdicts.push_back({rois[i].x_m, rois[i].y_m, std::hypot(rois[i].x_m, rois[i].y_m), rois[i].height_m, scores[i],
                          rois[i].person});
  std::stable_sort(verdicts.begin(), verdicts.end(), [](const auto& a, const auto& b) { return a.score > b.score; });

  std::vector<Pedestrian> people;
  for (const Pedestrian& verdict : verdicts)
    if (std::none_of(people.begin(), people.end(),
                     [&](const Pedestrian& surer) { return same_person(surer, verdict, options); }))
      people.push_back(verdict);
  std::stable_sort(people.begin(), people.end(), [](const auto& a, const auto& b) { return a.range_m < b.range_m; });
  return people;
}

}  // namespace flies
