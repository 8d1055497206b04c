#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <vector>

#include "flies/core/mat_view.hpp"
#include "flies/core/random.hpp"
#include "flies/synth/render.hpp"

namespace flies {
namespace {

/// Window of OpenCV's 48 x 96 people detector; its people are 72 px tall, so the window is 4/3 of the person.
constexpr double kWindowPerPerson = 96.0 / 72.0;
/// Decision value at which classify uses this detector.
constexpr double kThreshold = 1.0;

cv::Mat as_mat(const GrayImage& image) { return mat_of(image.view()).clone(); }

/// Decision value of the detector for a person of this height with feet and head centred around (u, v).
double hog_score(const cv::Mat& gray, double centre_u, double centre_v, double person_height_px) {
  static const cv::HOGDescriptor hog = [] {
    cv::HOGDescriptor descriptor({48, 96}, {16, 16}, {8, 8}, {8, 8}, 9);
    descriptor.setSVMDetector(cv::HOGDescriptor::getDaimlerPeopleDetector());
    return descriptor;
  }();
  // Cut out finer than needed and averaged down, so that large people do not alias.
  const int fine = std::max(1, static_cast<int>(std::lround(person_height_px * kWindowPerPerson / 96.0)));
  const double scale = person_height_px * kWindowPerPerson / 96.0 / fine;
  const cv::Matx23d window_to_image(scale, 0, centre_u - 0.5 * (48 * fine - 1) * scale, 0, scale,
                                    centre_v - 0.5 * (96 * fine - 1) * scale);
  cv::Mat window;
  cv::warpAffine(gray, window, window_to_image, {48 * fine, 96 * fine}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  cv::resize(window, window, {48, 96}, 0, 0, cv::INTER_AREA);
  std::vector<cv::Point> places;
  std::vector<double> weights;
  hog.detect(window, places, weights, -100.0);
  return weights.empty() ? -100.0 : weights.front();
}

/// The best of a few windows around the box, as a detector that scans sees it.
double best_score(const cv::Mat& gray, const ImageBox& box) {
  double best = -100.0;
  for (const double shift : {-0.05, 0.0, 0.05})
    for (const double lift : {-0.04, 0.0, 0.04})
      for (const double grow : {0.92, 1.0, 1.1})
        best = std::max(best, hog_score(gray, box.u_px + 0.5 * box.width_px + shift * box.height_px,
                                        box.v_px + (0.5 + lift) * box.height_px, grow * box.height_px));
  return best;
}

SceneOptions crowd(std::uint64_t seed) {
  SceneOptions options;
  options.seed = seed;
  options.people = 10;
  options.people_min_range_m = 7.0;
  options.people_max_range_m = 19.0;
  options.children = 0.0;
  return options;
}

TEST(SyntheticPeople, AreFoundByOpenCvsPeopleDetector) {
  int people = 0, found = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto pair = render_pair(crowd(seed));
    const auto gray = as_mat(pair.left_gray);
    for (const auto& object : pair.objects) {
      if (object.kind != ObjectClass::pedestrian || object.occlusion > 0.02 || object.truncation > 0.0) continue;
      if (object.near_range_m < 6.0 || object.near_range_m > 20.0) continue;
      ++people;
      if (best_score(gray, object.box) > kThreshold) ++found;
    }
  }
  ASSERT_GE(people, 20);
  // Measured: 43 of 44 over the seeds 1 to 6.
  EXPECT_GE(found, 0.85 * people) << found << " of " << people;
}

TEST(SyntheticPeople, AreNotFoundInStreetsWithoutThem) {
  int boxes = 0, wrong = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    auto options = crowd(seed);
    options.people = 0;
    const auto empty = as_mat(render_pair(options).left_gray);
    for (std::uint32_t i = 0; i < 200; ++i) {
      FlyRandom random(seed, 1, 0, i);
      const double height_px = random.uniform(64.0, 160.0);
      const ImageBox box{random.uniform(0.0, 1242.0 - 0.4 * height_px), random.uniform(100.0, 370.0 - height_px),
                         0.4 * height_px, height_px};
      ++boxes;
      if (best_score(empty, box) > kThreshold) ++wrong;
    }
  }
  // Measured: 1 of 400, each the best of 27 windows.
  EXPECT_LE(wrong, 0.02 * boxes) << wrong << " of " << boxes;
}

}  // namespace
}  // namespace flies
