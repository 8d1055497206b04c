#include "flies/eval/measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>

#include "flies/core/quantile.hpp"

namespace flies {
namespace {

constexpr std::size_t kBandCount = kRangeBands_m.size() - 1;

/// Collects what an `Accuracy` is made of.
struct Tally {
  Rate recall, precision, label_precision;
  std::vector<double> range_errors, width_errors_m, depth_errors_m, height_errors_m;

  void add_errors(const ObstacleVerdict& verdict) {
    if (!(verdict.near_range_m > 0.0)) return;  // we stand in it: there is no near face to be off from
    range_errors.push_back(verdict.range_error_m / verdict.near_range_m);
    width_errors_m.push_back(verdict.width_error_m);
    depth_errors_m.push_back(verdict.depth_error_m);
    height_errors_m.push_back(verdict.height_error_m);
  }
};

std::optional<double> absolute_median(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return median(std::move(values));
}

Accuracy accuracy_of(const Tally& tally) {
  return {tally.recall,
          tally.precision,
          tally.label_precision,
          median(tally.range_errors),
          absolute_median(tally.range_errors),
          median(tally.width_errors_m),
          absolute_median(tally.width_errors_m),
          median(tally.depth_errors_m),
          absolute_median(tally.depth_errors_m),
          median(tally.height_errors_m),
          absolute_median(tally.height_errors_m)};
}

void add(Rate& rate, bool hit) {
  rate.hits += hit;
  ++rate.total;
}

/// Number of the band; the last one includes its far end. Nothing outside all of them.
std::optional<std::size_t> band_of(double range_m) {
  if (!(range_m >= kRangeBands_m.front() && range_m <= kRangeBands_m.back())) return std::nullopt;
  const auto above = std::upper_bound(kRangeBands_m.begin(), kRangeBands_m.end(), range_m);
  return std::min(static_cast<std::size_t>(above - kRangeBands_m.begin()) - 1, kBandCount - 1);
}

/// The sums while frames are gone through.
struct Sums {
  Tally all;
  Rate people;
  std::map<std::string, Tally> by_class;
  std::array<Tally, kBandCount> by_range;
  std::vector<double> whole_width_errors_m, whole_depth_errors_m;
  std::size_t obstacles = 0;
  int reports = 0, reported_objects = 0;
};

void add_obstacles(const FrameTruth& truth, const FrameScore& score, Sums& sums) {
  sums.obstacles += score.obstacles.size();
  for (const auto& verdict : score.obstacles) {
    const auto add_verdict = [&](Tally& tally) {
      add(score.has_lidar ? tally.precision : tally.label_precision, verdict.right);
    };
    add_verdict(sums.all);
    if (const auto band = band_of(verdict.range_m)) add_verdict(sums.by_range[*band]);
    if (verdict.object < 0 || !score.objects[static_cast<std::size_t>(verdict.object)].counted) continue;
    const auto& object = truth.objects[static_cast<std::size_t>(verdict.object)];
    sums.all.add_errors(verdict);
    if (is_seen_whole(object) && verdict.near_range_m > 0.0) {
      sums.whole_width_errors_m.push_back(verdict.width_error_m);
      sums.whole_depth_errors_m.push_back(verdict.depth_error_m);
    }
    sums.by_class[object.type].add_errors(verdict);
    if (const auto band = band_of(near_range_m(object.footprint))) sums.by_range[*band].add_errors(verdict);
  }
}

void add_objects(const FrameTruth& truth, const FrameScore& score, Sums& sums, std::vector<MissedObject>& missed) {
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    const auto& object = truth.objects[i];
    const auto& verdict = score.objects[i];
    if (!verdict.counted) continue;
    const double range_m = near_range_m(object.footprint);
    add(sums.all.recall, verdict.found);
    add(sums.by_class[object.type].recall, verdict.found);
    if (const auto band = band_of(range_m)) add(sums.by_range[*band].recall, verdict.found);
    if (is_person(object) && range_m <= kPeopleReach_m) add(sums.people, verdict.found);
    if (!verdict.found) missed.push_back({truth.frame, truth.name, object});
    sums.reports += verdict.reports;
    sums.reported_objects += verdict.reports > 0;
  }
}

}  // namespace

bool is_person(const LabelledObject& object) {
  return object.type == "Pedestrian" || object.type == "Cyclist" || object.type == "Person_sitting" ||
         object.type == "Person (sitting)";
}

bool is_seen_whole(const LabelledObject& object) {
  constexpr double kWhole = 0.98;  // boxes are labelled a little too large
  return (is_person(object) || object.type == "Car" || object.type == "Van") && object.occlusion <= 0 &&
         object.in_view_fraction >= kWhole && object.truncation <= 1.0 - kWhole;
}

Measures summarize(std::span<const FrameTruth> truths, std::span<const FrameScore> scores) {
  std::vector<std::size_t> frames(truths.size());
  std::iota(frames.begin(), frames.end(), std::size_t{0});
  return summarize(truths, scores, frames);
}

Measures summarize(std::span<const FrameTruth> truths, std::span<const FrameScore> scores,
                   std::span<const std::size_t> frames) {
  assert(truths.size() == scores.size());
  Sums sums;
  Measures measures;
  for (const std::size_t f : frames) {
    add_obstacles(truths[f], scores[f], sums);
    add_objects(truths[f], scores[f], sums, measures.missed);
  }
  measures.all = accuracy_of(sums.all);
  measures.whole_width_error_m = absolute_median(std::move(sums.whole_width_errors_m));
  measures.whole_depth_error_m = absolute_median(std::move(sums.whole_depth_errors_m));
  measures.people_recall = sums.people;
  for (const auto& [name, tally] : sums.by_class) measures.by_class.push_back({name, accuracy_of(tally)});
  for (std::size_t i = 0; i < kBandCount; ++i) {
    measures.by_range.push_back(
        {fmt::format("{:.0f}-{:.0f} m", kRangeBands_m[i], kRangeBands_m[i + 1]), accuracy_of(sums.by_range[i])});
  }
  if (!frames.empty())
    measures.obstacles_per_frame = static_cast<double>(sums.obstacles) / static_cast<double>(frames.size());
  if (sums.reported_objects > 0)
    measures.reports_per_found_object = static_cast<double>(sums.reports) / sums.reported_objects;
  return measures;
}

}  // namespace flies
