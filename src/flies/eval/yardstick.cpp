#include "flies/eval/yardstick.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "flies/concentrate/concentrate.hpp"
#include "flies/core/error.hpp"
#include "flies/core/field.hpp"
#include "flies/core/mat_view.hpp"
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
constexpr double kMiddle = 0.5;       // of the points that share a range

/// Disparities in sixteenths of a pixel, below those of infinity where there are none.
cv::Mat match(const RectifiedPair& pair, const Projection& projection, DenseMatcher matcher, double near_m) {
  const int least_px = static_cast<int>(std::floor(projection.disparity_offset_px()));
  if (!(near_m > 0.0)) throw InputError("dense matching", "near_m", fmt::format("found {}, expected above 0", near_m));
  // No pixel has a match farther away than the image is wide.
  const double span_px = std::min(projection.disparity_at_depth(near_m) - least_px, 1.0 * pair.left.width_px);
  const int count = kDisparityStep * std::max(1, static_cast<int>(std::ceil(span_px / kDisparityStep)));
  const int mode = matcher == DenseMatcher::sgbm ? cv::StereoSGBM::MODE_SGBM : cv::StereoSGBM::MODE_SGBM_3WAY;
  const auto sgbm = cv::StereoSGBM::create(least_px, count, kBlock_px, kSmallPenalty, kLargePenalty, kLeftRightGap_px,
                                           kPreFilterCap, kUniqueness_percent, kSpeckle_px, kSpeckleGap_px, mode);
  // OpenCV gives no disparity to columns nearer to the left edge than the largest one.
  const int margin_px = std::max(0, least_px + count);
  const auto continued = [&](const GrayView& image) {
    cv::Mat wide;
    cv::copyMakeBorder(mat_of(image), wide, 0, 0, margin_px, 0, cv::BORDER_REPLICATE);
    return wide;
  };
  cv::Mat disparity;
  sgbm->compute(continued(pair.left), continued(pair.right), disparity);
  disparity = disparity.colRange(margin_px, disparity.cols).clone();
  for (int v = 0; v < disparity.rows; ++v)
    for (int u = 0; u < disparity.cols; ++u)
      if (auto& found = disparity.at<std::int16_t>(v, u); found > u * kFixedPoint)
        found = static_cast<std::int16_t>((least_px - 1) * kFixedPoint);
  return disparity;
}

/// The point that the pixel shows; nothing where it was not matched, or at infinity.
std::optional<Point3> point_at(const cv::Mat& disparity, const Projection& projection, int u, int v) {
  const double disparity_px = disparity.at<std::int16_t>(v, u) / kFixedPoint;
  if (!(disparity_px > projection.disparity_offset_px())) return std::nullopt;
  return projection.triangulate({static_cast<double>(u), static_cast<double>(v), disparity_px});
}

Population points_in_field(const cv::Mat& disparity, const Projection& projection, const RoadPlane& road,
                           const FieldOptions& field, int step_px) {
  Population points;
  for (int v = step_px / 2; v < disparity.rows; v += step_px)
    for (int u = step_px / 2; u < disparity.cols; u += step_px)
      if (const auto point = point_at(disparity, projection, u, v); point && in_field(field, road, *point))
        points.push_back(*point, 1.0F);
  return points;
}

DenseRanges ranges_of(const cv::Mat& disparity, const Projection& projection, const RoadPlane& road,
                      const Bearings& bearings, double min_range_m, const MatchOptions& standing) {
  DenseRanges ranges{bearings, std::vector<std::vector<double>>(bearings.count)};
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = 0; u < disparity.cols; ++u) {
      const auto point = point_at(disparity, projection, u, v);
      if (!point) continue;
      const double above_road_m = point->z_m - road.z_m(point->x_m, point->y_m);
      if (above_road_m < standing.min_above_road_m || above_road_m > standing.max_above_road_m) continue;
      const double range_m = std::hypot(point->x_m, point->y_m);
      if (range_m < min_range_m) continue;
      if (const auto sector = bearings.sector_of(std::atan2(point->y_m, point->x_m)))
        ranges.of_sector_m[*sector].push_back(range_m);
    }
  }
  for (auto& of_sector_m : ranges.of_sector_m) std::sort(of_sector_m.begin(), of_sector_m.end());
  return ranges;
}

}  // namespace

Scan dense_scan(const DenseRanges& ranges, int points, const DenseOptions& dense) {
  Scan scan;
  scan.angle_min_rad = ranges.bearings.angle_min_rad;
  scan.angle_increment_rad = ranges.bearings.angle_increment_rad;
  for (const auto& ranges_m : ranges.of_sector_m) {
    const auto range_m =
        shared_range_m(ranges_m, static_cast<std::size_t>(points), dense.scan_gap_m, dense.scan_gap_per_range, kMiddle);
    scan.ranges_m.push_back(range_m.value_or(std::numeric_limits<double>::quiet_NaN()));
    scan.free_m.push_back(0.0);  // dense points say nothing of the ground
    scan.confidence.push_back(1.0);
    scan.states.push_back(range_m ? SectorState::obstacle : SectorState::free);
  }
  return scan;
}

std::vector<float> dense_disparity(const RectifiedPair& pair, const StereoCamera& camera, DenseMatcher matcher,
                                   double near_m) {
  check_pair(pair);
  check_camera_fits(camera, pair.left.width_px, pair.left.height_px, "camera");
  const Projection projection(camera);
  const cv::Mat found = match(pair, projection, matcher, near_m);
  std::vector<float> disparity_px;
  for (int v = 0; v < found.rows; ++v)
    for (int u = 0; u < found.cols; ++u) {
      const double value_px = found.at<std::int16_t>(v, u) / kFixedPoint;
      disparity_px.push_back(value_px > projection.disparity_offset_px() ? static_cast<float>(value_px)
                                                                         : std::numeric_limits<float>::quiet_NaN());
    }
  return disparity_px;
}

DenseDetection detect_densely(const RectifiedPair& pair, const StereoCamera& camera, DenseMatcher matcher,
                              const DetectorOptions& options, const DenseOptions& dense, const MatchOptions& standing,
                              double sector_deg) {
  check_options(dense, "dense options");
  check_field(options.field, "field options");
  check_options(standing, "match options");
  if (!(sector_deg > 0.0))
    throw InputError("dense detection", "sector_deg", fmt::format("found {}, expected above 0", sector_deg));
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
  const cv::Mat disparity = match(pair, projection, matcher, dense.near_share * options.field.x_min_m);
  found.match_ms = lap_ms();
  const Population points = points_in_field(disparity, projection, road, options.field, dense.step_px);
  found.points = points.size();
  ConcentrateOptions concentrating = options.concentrate;
  concentrating.samples = std::max(concentrating.samples, dense.samples);
  concentrating.assemble.min_score = dense.min_score;
  found.obstacles = concentrate(points, projection, road, options.field, concentrating).obstacles;
  found.concentrate_ms = lap_ms();
  const Bearings bearings = common_view(camera, sector_deg * std::numbers::pi / 180.0);
  found.ranges = ranges_of(disparity, projection, road, bearings, dense.scan_min_range_m, standing);
  return found;
}

}  // namespace flies
