#include "flies/eval/truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "flies/core/convert.hpp"
#include "flies/core/matrix3.hpp"
#include "flies/core/quantile.hpp"

namespace flies {
namespace {

// Rising this much less than a kerb over the fitted plane still counts as road when the plane is refined.
constexpr std::array<double, 5> kPlaneGates_m = {0.6, 0.4, 0.3, 0.2, 0.2};
constexpr double kPlaneReach_m = 35.0;  // farther returns from the road are too sparse to steer the fit
constexpr double kCell_m = 1.0;
constexpr int kNeighbourCells = 3;        // the road is looked for up to 3.5 m around a point
constexpr double kMaxCorrection_m = 0.6;  // cells that differ more from the plane hold no road return
constexpr std::size_t kMinCellPoints = 2;
constexpr std::size_t kMinRoadCells = 4;
constexpr double kLowQuantile = 0.1;    // of a cell's returns: the road, with single low outliers ignored
constexpr double kRoadQuantile = 0.25;  // of the cells: most of those beside an object hold road at their low end
constexpr double kLabelSlack_m = 0.1;
constexpr double kClearOfRoad_m = 0.2;  // above the noise of the road fit, below a car's bumper
constexpr double kNear_m = 0.5;         // corners closer to the image plane than this are moved away from it

struct Plane {
  double height = 0.0, slope = 0.0, bank = 0.0;
  double residual(const Point3& p) const { return p.z_m - height - slope * p.x_m - bank * p.y_m; }
};

/// Least squares over the points within the gate of the present plane; the plane itself when they do not fix one.
Plane refine(const Plane& plane, std::span<const Point3> points, double gate_m) {
  Matrix3 normal{};
  std::array<double, 3> right{};
  for (const auto& p : points) {
    if (!(p.x_m <= kPlaneReach_m) || !std::isfinite(p.y_m) || !(std::abs(plane.residual(p)) <= gate_m)) continue;
    const std::array<double, 3> row = {1.0, p.x_m, p.y_m};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) normal[i][j] += row[i] * row[j];
      right[i] += row[i] * p.z_m;
    }
  }
  const double full = determinant(normal);
  if (!(full > 1e-6 * normal[0][0])) return plane;
  std::array<double, 3> solution{};
  for (std::size_t k = 0; k < 3; ++k) {
    auto replaced = normal;
    for (std::size_t i = 0; i < 3; ++i) replaced[i][k] = right[i];
    solution[k] = determinant(replaced) / full;
  }
  return {solution[0], solution[1], solution[2]};
}

using Cell = std::pair<int, int>;
Cell cell_of(const Point3& p) {
  // Far from the ends of int: neighbours are counted from here.
  const auto index = [](double at_m) { return saturated<int>(std::clamp(std::floor(at_m / kCell_m), -1e9, 1e9)); };
  return {index(p.x_m), index(p.y_m)};
}

/// How far the road around the cell lies over the plane.
double correction_m(const std::map<Cell, double>& low_of_cell, Cell centre) {
  std::vector<double> lows;
  for (int dx = -kNeighbourCells; dx <= kNeighbourCells; ++dx) {
    for (int dy = -kNeighbourCells; dy <= kNeighbourCells; ++dy) {
      const auto found = low_of_cell.find({centre.first + dx, centre.second + dy});
      if (found != low_of_cell.end() && std::abs(found->second) < kMaxCorrection_m) lows.push_back(found->second);
    }
  }
  return lows.size() < kMinRoadCells ? 0.0 : quantile(lows, kRoadQuantile);
}

/// Corners of the box around the object's projection.
struct PixelRectangle {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;
  bool contains(double u, double v) const { return u >= left && u <= right && v >= top && v <= bottom; }
  double area() const { return std::max(0.0, right - left) * std::max(0.0, bottom - top); }
};

PixelRectangle project_box(const Projection& projection, const LabelledObject& object) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PixelRectangle box{kInfinity, kInfinity, -kInfinity, -kInfinity};
  const Footprint& base = object.footprint;
  const double c = std::cos(base.yaw_rad), s = std::sin(base.yaw_rad);
  for (const double along : {-base.length_m / 2, base.length_m / 2}) {
    for (const double across : {-base.width_m / 2, base.width_m / 2}) {
      for (const double up : {0.0, object.height_m}) {
        Point3 corner{base.x_m + c * along - s * across, base.y_m + s * along + c * across, object.bottom_z_m + up};
        corner.x_m += std::max(0.0, kNear_m - projection.depth_m(corner));
        const StereoPoint pixel = projection.project(corner);
        box = {std::min(box.left, pixel.u_px), std::min(box.top, pixel.v_px), std::max(box.right, pixel.u_px),
               std::max(box.bottom, pixel.v_px)};
      }
    }
  }
  return box;
}

PixelRectangle clip_to_image(const StereoCamera& camera, const PixelRectangle& box) {
  return {std::max(box.left, 0.0), std::max(box.top, 0.0), std::min(box.right, camera.width_px - 1.0),
          std::min(box.bottom, camera.height_px - 1.0)};
}

}  // namespace

Point3 vehicle_from_left_camera(const StereoCamera& camera, const Projection& projection, const Point3& in_camera) {
  return projection.triangulate({camera.cx_px + camera.fx_px * in_camera.x_m / in_camera.z_m,
                                 camera.cy_px + camera.fy_px * in_camera.y_m / in_camera.z_m,
                                 projection.disparity_at_depth(in_camera.z_m)});
}

std::vector<LidarPoint> measure_above_road(std::span<const Point3> points) {
  Plane plane;
  for (const double gate_m : kPlaneGates_m) plane = refine(plane, points, gate_m);

  std::map<Cell, std::vector<double>> residuals;
  for (const auto& p : points)
    if (std::isfinite(plane.residual(p))) residuals[cell_of(p)].push_back(plane.residual(p));
  std::map<Cell, double> low_of_cell;
  for (auto& [cell, values] : residuals) {
    if (values.size() >= kMinCellPoints) low_of_cell[cell] = quantile(values, kLowQuantile);
  }
  std::map<Cell, double> road_of_cell;
  for (const auto& entry : residuals) road_of_cell[entry.first] = correction_m(low_of_cell, entry.first);

  std::vector<LidarPoint> measured;
  measured.reserve(points.size());
  for (const auto& p : points) measured.push_back({p, plane.residual(p) - road_of_cell[cell_of(p)]});
  return measured;
}

bool is_on_object(const LabelledObject& object, const LidarPoint& lidar) {
  return lidar.above_road_m > kClearOfRoad_m && lidar.point.z_m < object.bottom_z_m + object.height_m + kLabelSlack_m &&
         distance_to_footprint_m(object.footprint, lidar.point.x_m, lidar.point.y_m) <= kLabelSlack_m;
}

void measure_visibility(const StereoCamera& camera, FrameTruth& truth) {
  const Projection projection(camera);
  for (auto& object : truth.objects) {
    const PixelRectangle box = project_box(projection, object);
    object.in_view_fraction = box.area() > 0.0 ? clip_to_image(camera, box).area() / box.area() : 0.0;
    object.lidar_points = static_cast<int>(std::count_if(
        truth.lidar.begin(), truth.lidar.end(), [&](const LidarPoint& lidar) { return is_on_object(object, lidar); }));
  }
}

void complete_boxes(const StereoCamera& camera, FrameTruth& truth) {
  const Projection projection(camera);
  for (auto& object : truth.objects) {
    const Footprint& base = object.footprint;
    const Point3 foot{base.x_m, base.y_m, object.bottom_z_m};
    const double depth_m = projection.depth_m(foot);
    if (object.box.height_px > 0.0 || depth_m < kNear_m) continue;
    const StereoPoint low = projection.project(foot);
    const StereoPoint high = projection.project({foot.x_m, foot.y_m, foot.z_m + object.height_m});
    const double width_px = camera.fx_px * seen_width_m(base) / depth_m;
    object.box = {(low.u_px + high.u_px - width_px) / 2.0, high.v_px, width_px, low.v_px - high.v_px};
  }
}

double free_fraction(const StereoCamera& camera, const FrameTruth& truth, const LabelledObject& object) {
  constexpr int kSamples = 24;  // along each side: about 4 % of the box a row
  const Projection projection(camera);
  const PixelRectangle box = clip_to_image(camera, project_box(projection, object));
  std::vector<PixelRectangle> nearer;
  for (const auto& other : truth.objects) {
    if (near_range_m(other.footprint) < near_range_m(object.footprint)) {
      nearer.push_back(project_box(projection, other));
    }
  }
  int free = 0;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const double u = box.left + (i + 0.5) / kSamples * (box.right - box.left);
      const double v = box.top + (j + 0.5) / kSamples * (box.bottom - box.top);
      free += std::none_of(nearer.begin(), nearer.end(), [&](const auto& other) { return other.contains(u, v); });
    }
  }
  return static_cast<double>(free) / (kSamples * kSamples);
}

}  // namespace flies
