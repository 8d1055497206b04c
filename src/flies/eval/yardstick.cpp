#include "flies/eval/yardstick.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <utility>

#include "flies/concentrate/concentrate.hpp"
#include "flies/core/field.hpp"
#include "flies/road/road.hpp"

namespace flies {
namespace {

constexpr int kBlock_px = 5;
constexpr int kSmallPenalty = 8 * kBlock_px * kBlock_px, kLargePenalty = 32 * kBlock_px * kBlock_px;
constexpr int kLeftRightGap_px = 1;
constexpr int kPreFilterCap = 63;
constexpr int kUniqueness_percent = 10;
constexpr int kSpeckle_px = 100;      // matched patches of fewer pixels are taken for false
constexpr int kSpeckleGap_px = 2;     // disparities that differ by less belong to one patch
constexpr int kDisparityStep = 16;    // OpenCV asks for a number of disparities that is a multiple of it
constexpr double kFixedPoint = 16.0;  // and counts disparities in sixteenths of a pixel

/// OpenCV has no view of constant pixels; it only reads them here.
cv::Mat view_of(const GrayView& image) {
  return {image.height_px, image.width_px, CV_8UC1, const_cast<std::uint8_t*>(image.data),
          static_cast<std::size_t>(image.stride)};
}

cv::Mat match(const RectifiedPair& pair, const Projection& projection, DenseMatcher matcher,
              const FieldOptions& field) {
  const int least_px = static_cast<int>(std::floor(projection.disparity_offset_px()));
  const double span_px = projection.disparity_at_depth(field.x_min_m) - least_px;
  const int count = kDisparityStep * std::max(1, static_cast<int>(std::ceil(span_px / kDisparityStep)));
  const int mode = matcher == DenseMatcher::sgbm ? cv::StereoSGBM::MODE_SGBM : cv::StereoSGBM::MODE_SGBM_3WAY;
  const auto sgbm = cv::StereoSGBM::create(least_px, count, kBlock_px, kSmallPenalty, kLargePenalty, kLeftRightGap_px,
                                           kPreFilterCap, kUniqueness_percent, kSpeckle_px, kSpeckleGap_px, mode);
  cv::Mat disparity;
  sgbm->compute(view_of(pair.left), view_of(pair.right), disparity);
  return disparity;
}

Population points_in_field(const cv::Mat& disparity, const Projection& projection, const RoadPlane& road,
                           const FieldOptions& field, int step_px) {
  Population points;
  for (int v = step_px / 2; v < disparity.rows; v += step_px) {
    for (int u = step_px / 2; u < disparity.cols; u += step_px) {
      const double disparity_px = disparity.at<std::int16_t>(v, u) / kFixedPoint;
      if (!(disparity_px > projection.disparity_offset_px())) continue;  // not matched, or at infinity
      const Point3 point = projection.triangulate({static_cast<double>(u), static_cast<double>(v), disparity_px});
      if (in_field(field, road, point)) points.push_back(point, 1.0F);
    }
  }
  return points;
}

}  // namespace

DenseDetection detect_densely(const RectifiedPair& pair, const StereoCamera& camera, DenseMatcher matcher,
                              const DetectorOptions& options, const DenseOptions& dense) {
  check_pair(pair);
  check_camera_fits(camera, pair.left.width_px, pair.left.height_px, "camera");
  DenseDetection found;
  auto start = std::chrono::steady_clock::now();
  const auto lap_ms = [&] {
    const auto end = std::chrono::steady_clock::now();
    return std::chrono::duration<double, std::milli>(end - std::exchange(start, end)).count();
  };
  const Projection projection(camera);
  const RoadPlane road = estimate_road(pair, projection, options.road).plane;
  found.road_ms = lap_ms();
  const cv::Mat disparity = match(pair, projection, matcher, options.field);
  found.match_ms = lap_ms();
  const Population points = points_in_field(disparity, projection, road, options.field, dense.step_px);
  found.points = points.size();
  ConcentrateOptions concentrating = options.concentrate;
  concentrating.samples = std::max(concentrating.samples, dense.samples);
  concentrating.assemble.min_score = dense.min_score;
  found.obstacles = concentrate(points, projection, road, options.field, concentrating).obstacles;
  found.concentrate_ms = lap_ms();
  return found;
}

}  // namespace flies
