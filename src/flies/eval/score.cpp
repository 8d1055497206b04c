#include "flies/eval/score.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "flies/core/quantile.hpp"

namespace flies {
namespace {

constexpr double kNearQuantile = 0.1;  // a few returns on mirrors, mud guards or label slack may lie before the face
constexpr double kDirectionSlack_m = 0.3;  // returns this far beside the line of sight still show the face there
constexpr std::size_t kMinFacePoints = 3;

int lidar_points_near(const FrameTruth& truth, const Obstacle& obstacle, const MatchOptions& options) {
  const double radius_m = options.radius_at_m(obstacle.range_m);
  return static_cast<int>(std::count_if(truth.lidar.begin(), truth.lidar.end(), [&](const LidarPoint& lidar) {
    return lidar.above_road_m >= options.min_above_road_m && lidar.above_road_m <= options.max_above_road_m &&
           std::hypot(lidar.point.x_m - obstacle.x_m, lidar.point.y_m - obstacle.y_m) <= radius_m;
  }));
}

/// The object that the obstacle was reported for, -1 for none.
int nearest_object(const FrameTruth& truth, const Obstacle& obstacle, double radius_m) {
  int nearest = -1;
  double nearest_m = radius_m;
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    const double distance_m = distance_to_footprint_m(truth.objects[i].footprint, obstacle.x_m, obstacle.y_m);
    if (distance_m > nearest_m || (distance_m == nearest_m && nearest >= 0)) continue;
    nearest = static_cast<int>(i);
    nearest_m = distance_m;
  }
  return nearest;
}

}  // namespace

double near_face_m(const FrameTruth& truth, const LabelledObject& object, double azimuth_rad) {
  std::vector<double> all, ahead;
  for (const auto& lidar : truth.lidar) {
    if (!is_on_object(object, lidar)) continue;
    const double range = std::hypot(lidar.point.x_m, lidar.point.y_m);
    all.push_back(range);
    const double beside = lidar.point.y_m * std::cos(azimuth_rad) - lidar.point.x_m * std::sin(azimuth_rad);
    if (std::abs(beside) <= kDirectionSlack_m) ahead.push_back(range);
  }
  if (ahead.size() >= kMinFacePoints) return quantile(std::move(ahead), kNearQuantile);
  if (all.size() >= kMinFacePoints) return quantile(std::move(all), kNearQuantile);
  return near_face_range_m(object.footprint, azimuth_rad).value_or(near_range_m(object.footprint));
}

FrameScore score_frame(const FrameTruth& truth, std::span<const Obstacle> obstacles, const MatchOptions& options) {
  FrameScore score;
  score.has_lidar = !truth.lidar.empty();
  score.objects.resize(truth.objects.size());
  for (const auto& obstacle : obstacles) {
    const double radius_m = options.radius_at_m(obstacle.range_m);
    ObstacleVerdict verdict;
    verdict.range_m = obstacle.range_m;
    verdict.object = nearest_object(truth, obstacle, radius_m);
    verdict.right =
        score.has_lidar ? lidar_points_near(truth, obstacle, options) >= options.min_lidar_points : verdict.object >= 0;
    if (verdict.object >= 0) {
      const auto& object = truth.objects[static_cast<std::size_t>(verdict.object)];
      ++score.objects[static_cast<std::size_t>(verdict.object)].reports;
      verdict.near_range_m = near_face_m(truth, object, std::atan2(obstacle.y_m, obstacle.x_m));
      verdict.range_error_m = obstacle.range_m - verdict.near_range_m;
      verdict.width_error_m = obstacle.width_m - seen_width_m(object.footprint);
      verdict.depth_error_m = obstacle.depth_m - seen_depth_m(object.footprint);
      verdict.height_error_m = obstacle.height_m - object.height_m;
    }
    score.obstacles.push_back(verdict);
  }
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    const auto& object = truth.objects[i];
    const double range_m = near_range_m(object.footprint);
    score.objects[i].counted = object.visible && range_m >= options.min_range_m && range_m <= options.max_range_m;
    score.objects[i].found = std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& obstacle) {
      return distance_to_footprint_m(object.footprint, obstacle.x_m, obstacle.y_m) <=
             options.radius_at_m(obstacle.range_m);
    });
  }
  return score;
}

std::vector<Obstacle> as_obstacles(std::span<const Pedestrian> pedestrians) {
  std::vector<Obstacle> obstacles;
  for (const auto& p : pedestrians) {
    Obstacle obstacle;
    obstacle.x_m = p.x_m;
    obstacle.y_m = p.y_m;
    obstacle.range_m = p.range_m;
    obstacle.height_m = p.height_m;
    obstacle.score = p.probability;
    obstacle.box = p.box;
    obstacles.push_back(obstacle);
  }
  return obstacles;
}

}  // namespace flies
