#include "flies/eval/person_paths.hpp"

#include <algorithm>
#include <cmath>

namespace flies {
namespace {

/// As few flies make no obstacle (`assemble.min_flies`).
constexpr std::size_t kHardlyAny = 3;

bool holds(const ImageBox& box, const StereoPoint& point) {
  return point.u_px >= box.u_px && point.u_px <= box.u_px + box.width_px && point.v_px >= box.v_px &&
         point.v_px <= box.v_px + box.height_px;
}

std::size_t count_flies(const LabelledObject& person, const Projection& projection, const Population& flies,
                        const MatchOptions& match) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < flies.size(); ++i) {
    const Point3 point = flies.point(i);
    const double range_m = std::hypot(point.x_m, point.y_m);
    count += flies.fitness[i] > 0.0F &&
             distance_to_footprint_m(person.footprint, point.x_m, point.y_m) <= match.radius_at_m(range_m) &&
             holds(person.box, projection.project(point));
  }
  return count;
}

bool has_obstacle(const LabelledObject& person, std::span<const Obstacle> obstacles, const MatchOptions& match) {
  return std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& obstacle) {
    return distance_to_footprint_m(person.footprint, obstacle.x_m, obstacle.y_m) <= match.radius_at_m(obstacle.range_m);
  });
}

PersonStage stage_of(const PersonPath& path, bool is_near_obstacle, double surest_look, const PersonVerdict* verdict,
                     double first_threshold, double threshold) {
  if (verdict != nullptr && verdict->person.probability > threshold) return PersonStage::found;
  if (!path.rank && path.flies < kHardlyAny) return PersonStage::no_flies;
  if (!path.rank && !is_near_obstacle) return PersonStage::no_obstacle;
  if (!path.rank) return PersonStage::no_box;
  if (!(surest_look > first_threshold)) return PersonStage::first_look;
  return verdict == nullptr ? PersonStage::suppression : PersonStage::second_look;
}

}  // namespace

PeopleTrail follow_people(const FrameTruth& truth, const StereoCamera& camera, const Detection& detection,
                          std::span<const Pedestrian> reports, double first_threshold, double threshold,
                          const PeopleOptions& people, const MatchOptions& match) {
  const Projection projection(camera);
  const PeopleFrame frame = score_people(truth, reports, people);
  PeopleTrail trail{{}, detection.rois.size()};
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    if (frame.roles[i] != PersonRole::counted) continue;
    const LabelledObject& person = truth.objects[i];
    PersonPath path;
    path.object = i;
    path.flies = count_flies(person, projection, detection.evolved.flies, match);
    double surest_look = -1.0;
    for (std::size_t k = 0; k < detection.rois.size(); ++k) {
      const double overlap = people_overlap(detection.rois[k].person, person.box);
      path.best_overlap = std::max(path.best_overlap, overlap);
      if (overlap >= people.min_overlap) surest_look = std::max(surest_look, detection.roi_scores[k]);
    }
    if (surest_look >= 0.0)
      path.rank = static_cast<std::size_t>(std::count_if(detection.roi_scores.begin(), detection.roi_scores.end(),
                                                         [&](double score) { return score > surest_look; }));
    const auto verdict = std::find_if(frame.verdicts.begin(), frame.verdicts.end(), [&](const PersonVerdict& v) {
      return v.kind == PersonVerdict::Kind::hit && v.object == static_cast<int>(i);
    });
    path.stage = stage_of(path, has_obstacle(person, detection.concentrate.obstacles, match), surest_look,
                          verdict == frame.verdicts.end() ? nullptr : &*verdict, first_threshold, threshold);
    trail.paths.push_back(path);
  }
  return trail;
}

PeopleLosses sum_up(std::span<const PeopleTrail> trails) {
  constexpr std::array<std::size_t, 5> kBoxes = {3, 10, 30, 100, 300};
  PeopleLosses losses;
  std::array<int, kBoxes.size()> within{};
  int people = 0, boxed = 0;
  std::size_t boxes = 0;
  for (const PeopleTrail& trail : trails) {
    boxes += trail.boxes;
    for (const PersonPath& path : trail.paths) {
      ++people;
      ++losses.people[static_cast<std::size_t>(path.stage)];
      boxed += path.rank.has_value();
      for (std::size_t n = 0; n < kBoxes.size(); ++n) within[n] += path.rank && *path.rank < kBoxes[n];
    }
  }
  if (!trails.empty()) losses.boxes_per_pair = static_cast<double>(boxes) / static_cast<double>(trails.size());
  if (people == 0) return losses;
  for (std::size_t n = 0; n < kBoxes.size(); ++n)
    losses.recall.emplace_back(kBoxes[n], static_cast<double>(within[n]) / people);
  losses.recall.emplace_back(std::nullopt, static_cast<double>(boxed) / people);
  return losses;
}

}  // namespace flies
