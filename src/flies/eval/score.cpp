#include "flies/eval/score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>

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

double quantile(std::vector<double> values, double q) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::optional<double> median(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  return quantile(std::move(values), 0.5);
}

double near_face_m(const FrameTruth& truth, const LabelledObject& object, const Obstacle& obstacle) {
  const double azimuth = std::atan2(obstacle.y_m, obstacle.x_m);
  std::vector<double> all, ahead;
  for (const auto& lidar : truth.lidar) {
    if (!is_on_object(object, lidar)) continue;
    const double range = std::hypot(lidar.point.x_m, lidar.point.y_m);
    all.push_back(range);
    const double beside = lidar.point.y_m * std::cos(azimuth) - lidar.point.x_m * std::sin(azimuth);
    if (std::abs(beside) <= kDirectionSlack_m) ahead.push_back(range);
  }
  if (ahead.size() >= kMinFacePoints) return quantile(std::move(ahead), kNearQuantile);
  if (all.size() >= kMinFacePoints) return quantile(std::move(all), kNearQuantile);
  return near_face_range_m(object.footprint, azimuth).value_or(near_range_m(object.footprint));
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

void add(Rate& rate, bool hit) {
  rate.hits += hit;
  ++rate.total;
}

std::string band_name(double range_m) {
  for (std::size_t i = 0; i + 1 < kRangeBands_m.size(); ++i) {
    if (range_m < kRangeBands_m[i + 1] || i + 2 == kRangeBands_m.size()) {
      return fmt::format("{:.0f}-{:.0f} m", kRangeBands_m[i], kRangeBands_m[i + 1]);
    }
  }
  return {};
}

}  // namespace

FrameScore score_frame(const FrameTruth& truth, std::span<const Obstacle> obstacles, const MatchOptions& options) {
  FrameScore score;
  score.has_lidar = !truth.lidar.empty();
  score.objects.resize(truth.objects.size());
  for (const auto& obstacle : obstacles) {
    const double radius_m = options.radius_at_m(obstacle.range_m);
    ObstacleVerdict verdict;
    verdict.object = nearest_object(truth, obstacle, radius_m);
    verdict.right =
        score.has_lidar ? lidar_points_near(truth, obstacle, options) >= options.min_lidar_points : verdict.object >= 0;
    if (verdict.object >= 0) {
      const auto& object = truth.objects[static_cast<std::size_t>(verdict.object)];
      ++score.objects[static_cast<std::size_t>(verdict.object)].reports;
      verdict.near_range_m = near_face_m(truth, object, obstacle);
      verdict.range_error_m = obstacle.range_m - verdict.near_range_m;
      verdict.width_error_m = obstacle.width_m - seen_width_m(object.footprint);
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
    obstacle.score = p.score;
    obstacle.box = p.box;
    obstacles.push_back(obstacle);
  }
  return obstacles;
}

bool is_person(const LabelledObject& object) {
  return object.type == "Pedestrian" || object.type == "Cyclist" || object.type == "Person_sitting" ||
         object.type == "Person (sitting)";
}

Measures summarize(std::span<const FrameTruth> truths, std::span<const FrameScore> scores) {
  assert(truths.size() == scores.size());
  Measures measures;
  std::map<std::string, Rate> by_class;
  for (std::size_t i = 0; i + 1 < kRangeBands_m.size(); ++i) {
    measures.recall_by_range.push_back({band_name(kRangeBands_m[i]), {}});
  }
  std::vector<double> signed_errors, absolute_errors, width_errors, height_errors;
  int obstacles = 0, reports = 0, reported_objects = 0;

  for (std::size_t f = 0; f < truths.size(); ++f) {
    const auto& truth = truths[f];
    const auto& score = scores[f];
    obstacles += static_cast<int>(score.obstacles.size());
    for (const auto& verdict : score.obstacles) {
      add(score.has_lidar ? measures.precision : measures.label_precision, verdict.right);
      if (verdict.object < 0 || !score.objects[static_cast<std::size_t>(verdict.object)].counted) continue;
      signed_errors.push_back(verdict.range_error_m / verdict.near_range_m);
      absolute_errors.push_back(std::abs(signed_errors.back()));
      width_errors.push_back(verdict.width_error_m);
      height_errors.push_back(verdict.height_error_m);
    }
    for (std::size_t i = 0; i < truth.objects.size(); ++i) {
      const auto& object = truth.objects[i];
      const auto& verdict = score.objects[i];
      if (!verdict.counted) continue;
      const double range_m = near_range_m(object.footprint);
      add(measures.recall, verdict.found);
      add(by_class[object.type], verdict.found);
      for (auto& part : measures.recall_by_range) {
        if (part.name == band_name(range_m)) add(part.recall, verdict.found);
      }
      if (is_person(object) && range_m <= kPeopleReach_m) add(measures.people_recall, verdict.found);
      if (!verdict.found) measures.missed.push_back({truth.frame, truth.name, object});
      if (verdict.reports > 0) {
        reports += verdict.reports;
        ++reported_objects;
      }
    }
  }
  for (const auto& [name, rate] : by_class) measures.recall_by_class.push_back({name, rate});
  measures.range_error = median(signed_errors);
  measures.absolute_range_error = median(absolute_errors);
  measures.width_error_m = median(width_errors);
  measures.height_error_m = median(height_errors);
  if (!truths.empty())
    measures.obstacles_per_frame = static_cast<double>(obstacles) / static_cast<double>(truths.size());
  if (reported_objects > 0) measures.reports_per_found_object = static_cast<double>(reports) / reported_objects;
  return measures;
}

}  // namespace flies
