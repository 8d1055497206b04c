#include "flies/eval/scan_truth.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>

namespace flies {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kNearFaceQuantile = 0.25;  // of the points that make a thing: its face, not its foremost noise
constexpr std::size_t kCoverage = 2;        // times the points that make a thing

struct SectorPoints {
  std::vector<double> ranges_m;  ///< of what stands on the road
  std::size_t points = 0;        ///< of any height
};

std::vector<SectorPoints> sort_into_sectors(std::span<const LidarPoint> points, const Bearings& bearings,
                                            const MatchOptions& match) {
  std::vector<SectorPoints> sectors(bearings.count);
  for (const auto& [point, above_road_m] : points) {
    const auto sector = bearings.sector_of(std::atan2(point.y_m, point.x_m));
    if (!sector) continue;
    ++sectors[*sector].points;
    if (above_road_m >= match.min_above_road_m && above_road_m <= match.max_above_road_m)
      sectors[*sector].ranges_m.push_back(std::hypot(point.x_m, point.y_m));
  }
  for (auto& sector : sectors) std::sort(sector.ranges_m.begin(), sector.ranges_m.end());
  return sectors;
}

/// True when both images show the place at half the height of what counts.
bool is_in_common_view(const StereoCamera& camera, const Projection& projection, double angle_rad, double range_m,
                       const MatchOptions& match, const SectorOptions& options) {
  const Point3 place{range_m * std::cos(angle_rad), range_m * std::sin(angle_rad),
                     (match.min_above_road_m + match.max_above_road_m) / 2.0};
  if (!(projection.depth_m(place) > 0.0)) return false;
  const StereoPoint pixel = projection.project(place);
  const auto is_inside = [&](double u_px) {
    return u_px >= options.margin_px && u_px <= camera.width_px - 1 - options.margin_px;
  };
  return is_inside(pixel.u_px) && is_inside(pixel.u_px - pixel.disparity_px);
}

}  // namespace

ScanTruth scan_truth(const FrameTruth& truth, const StereoCamera& camera, const MatchOptions& match,
                     const SectorOptions& options) {
  const bool has_map = !truth.map.empty();
  if (!has_map && truth.lidar.empty()) return {};
  const auto need = static_cast<std::size_t>(has_map ? options.map_points : options.lidar_points);
  const double gap_m = has_map ? options.map_gap_m : options.lidar_gap_m;

  ScanTruth scan;
  scan.bearings = common_view(camera, options.increment_deg * std::numbers::pi / 180.0);
  const Projection projection(camera);
  const auto sectors = sort_into_sectors(has_map ? truth.map : truth.lidar, scan.bearings, match);
  for (std::size_t i = 0; i < sectors.size(); ++i) {
    const bool is_covered = sectors[i].points >= kCoverage * need;
    const double range_m =
        is_covered ? shared_range_m(sectors[i].ranges_m, need, gap_m, options.gap_per_range, kNearFaceQuantile)
                         .value_or(kInfinity)
                   : kNaN;
    TrueSector kind = TrueSector::ignored;
    if (range_m >= options.open_range_m)
      kind = TrueSector::open;
    else if (range_m >= options.min_range_m && range_m <= options.max_range_m &&
             is_in_common_view(camera, projection, scan.bearings.angle_rad(i), range_m, match, options))
      kind = TrueSector::counted;
    scan.ranges_m.push_back(range_m);
    scan.kinds.push_back(kind);
  }
  return scan;
}

}  // namespace flies
