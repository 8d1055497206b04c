#include "flies/eval/hog_yardstick.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <utility>

#include "flies/classify/named_models.hpp"
#include "flies/core/error.hpp"
#include "flies/core/mat_view.hpp"

namespace flies {
namespace {

constexpr double kPersonShare = 0.75;   // height of the person over height of the window, in both training sets
constexpr double kPersonAspect = 0.41;  // width over height of a person
constexpr int kPadding_px = 16;         // windows may reach this far beyond the image
constexpr int kBlockStride_px = 8;

cv::HOGDescriptor descriptor(HogDetector detector) {
  const bool is_small = detector == HogDetector::hog_48x96;
  cv::HOGDescriptor hog(is_small ? cv::Size(48, 96) : cv::Size(64, 128), {16, 16}, {8, 8}, {8, 8}, 9);
  hog.setSVMDetector(is_small ? cv::HOGDescriptor::getDaimlerPeopleDetector()
                              : cv::HOGDescriptor::getDefaultPeopleDetector());
  return hog;
}

/// Head to feet in a window of the enlarged image.
ImageBox person_in(const cv::Rect& window, double enlarge) {
  const double height_px = kPersonShare * window.height / enlarge, width_px = kPersonAspect * height_px;
  const double centre_u_px = (window.x + window.width / 2.0) / enlarge;
  const double centre_v_px = (window.y + window.height / 2.0) / enlarge;
  return {centre_u_px - width_px / 2.0, centre_v_px - height_px / 2.0, width_px, height_px};
}

double log_odds(double probability) { return std::log(probability / (1.0 - probability)); }

}  // namespace

PeopleModel hog_model(HogDetector detector) {
  return detector == HogDetector::hog_48x96 ? opencv_48x96() : opencv_64x128();
}

PeopleSearch detect_people_by_hog(const GrayView& left, const StereoCamera& camera, HogDetector detector,
                                  double least_probability, const HogOptions& options) {
  check_options(options, "hog options");
  if (options.stride_px % kBlockStride_px != 0)
    throw InputError("options", "hog.stride_px",
                     fmt::format("found {}, expected a multiple of {}", options.stride_px, kBlockStride_px));
  check_camera_fits(camera, left.width_px, left.height_px, "camera");
  const cv::HOGDescriptor hog = descriptor(detector);
  const cv::Mat image = mat_of(left);
  const ScoreCalibration calibration = hog_model(detector).linear.calibration;
  const double least_score = (log_odds(least_probability) - calibration.offset) / calibration.slope;
  const auto start = std::chrono::steady_clock::now();
  cv::Mat searched = image;
  if (options.enlarge != 1.0)
    cv::resize(image, searched, {}, options.enlarge, options.enlarge,
               options.enlarge > 1.0 ? cv::INTER_LINEAR : cv::INTER_AREA);
  std::vector<cv::Rect> windows;
  std::vector<double> scores;
  constexpr double kNoGrouping = 0.0;
  hog.detectMultiScale(searched, windows, scores, least_score, {options.stride_px, options.stride_px},
                       {kPadding_px, kPadding_px}, options.scale_step, kNoGrouping);
  PeopleSearch found;
  found.time_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();

  const Projection projection(camera);
  for (std::size_t i = 0; i < windows.size(); ++i)
    found.people.push_back(
        person_in_box(person_in(windows[i], options.enlarge), probability(calibration, scores[i]), projection));
  found.people = keep_surest(std::move(found.people), options.max_overlap);
  return found;
}

}  // namespace flies
