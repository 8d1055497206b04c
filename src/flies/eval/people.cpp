#include "flies/eval/people.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "flies/core/box_overlap.hpp"
#include "flies/core/quantile.hpp"
#include "flies/eval/score.hpp"

namespace flies {
namespace {

constexpr double kAspect = 0.41;         // width over height of people, Dollar et al. 2012
constexpr double kInIgnored = 0.5;       // of a report's area
constexpr double kRoundingRange = 1e-9;  // of false-alarm rates that should meet a reference exactly

/// The box with the aspect that all people count with.
ImageBox standardised(const ImageBox& box) {
  const double width_px = kAspect * box.height_px;
  return {box.u_px + (box.width_px - width_px) / 2.0, box.v_px, width_px, box.height_px};
}

bool lies_in(const ImageBox& box, const ImageBox& region) {
  return area_px2(box) > 0.0 && intersection_px2(box, region) >= kInIgnored * area_px2(box);
}

/// The free counted person that the box overlaps most, -1 when none enough.
int best_person(const FrameTruth& truth, const std::vector<PersonRole>& roles, const std::vector<bool>& taken,
                const ImageBox& box, const PeopleOptions& options) {
  int best = -1;
  double best_overlap = options.min_overlap;
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    if (roles[i] != PersonRole::counted || taken[i]) continue;
    const double overlap = intersection_over_union(box, standardised(truth.objects[i].box));
    if (overlap < best_overlap || (overlap == best_overlap && best >= 0)) continue;
    best = static_cast<int>(i);
    best_overlap = overlap;
  }
  return best;
}

bool is_ignored(const FrameTruth& truth, const std::vector<PersonRole>& roles, const ImageBox& box) {
  for (std::size_t i = 0; i < truth.objects.size(); ++i)
    if (roles[i] == PersonRole::ignored && lies_in(box, standardised(truth.objects[i].box))) return true;
  return std::any_of(truth.ignored_regions.begin(), truth.ignored_regions.end(),
                     [&](const ImageBox& region) { return lies_in(box, region); });
}

void measure_hit(const FrameTruth& truth, const LabelledObject& object, PersonVerdict& verdict) {
  const auto& person = verdict.person;
  verdict.near_range_m = near_face_m(truth, object, std::atan2(person.y_m, person.x_m));
  verdict.range_error_m = person.range_m - verdict.near_range_m;
  const double azimuth_rad = std::atan2(object.footprint.y_m, object.footprint.x_m);
  const double near_m = near_face_m(truth, object, azimuth_rad);
  verdict.position_error_m =
      std::hypot(person.x_m - near_m * std::cos(azimuth_rad), person.y_m - near_m * std::sin(azimuth_rad));
}

/// Ends of the bands up to the farthest person to be found; all nearer than 10 m are one band.
std::vector<double> band_ends_m(const PeopleOptions& options) {
  std::vector<double> ends(kRangeBands_m.begin(), kRangeBands_m.end());
  ends.front() = 0.0;
  std::erase_if(ends, [&](double end) { return end >= options.max_range_m; });
  ends.push_back(options.max_range_m);
  return ends;
}

bool in_band(double range_m, double from_m, double to_m, bool is_last) {
  return range_m >= from_m && (range_m < to_m || (is_last && range_m == to_m));
}

/// What one call of `values_of` counts: all, or one band.
struct Selection {
  MeasureKey::Group group = MeasureKey::Group::all;
  std::string part;
  double from_m = 0.0, to_m = 0.0;
  bool is_last = false;

  bool holds(double range_m) const {
    return group == MeasureKey::Group::all || in_band(range_m, from_m, to_m, is_last);
  }
};

std::vector<Selection> selections(const PeopleOptions& options) {
  std::vector<Selection> all = {{}};
  const auto ends = band_ends_m(options);
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    all.push_back({MeasureKey::Group::by_range, fmt::format("{:g}-{:g} m", ends[i], ends[i + 1]), ends[i], ends[i + 1],
                   i + 2 == ends.size()});
  return all;
}

int count_people(const PeopleFrame& frame, const Selection& selection) {
  int people = 0;
  for (std::size_t i = 0; i < frame.roles.size(); ++i)
    people += frame.roles[i] == PersonRole::counted && selection.holds(frame.ranges_m[i]);
  return people;
}

/// A hit's band is that of the labelled person.
double range_of(const PeopleFrame& frame, const PersonVerdict& verdict) {
  return verdict.kind == PersonVerdict::Kind::hit ? frame.ranges_m[static_cast<std::size_t>(verdict.object)]
                                                  : verdict.person.range_m;
}

/// Hits and false alarms of some frames, the surest first.
struct Reports {
  std::vector<const PersonVerdict*> verdicts;
  int people = 0;
  std::size_t frames = 0;

  void add(const PeopleFrame& frame, const Selection& selection) {
    for (const auto& verdict : frame.verdicts)
      if (verdict.kind != PersonVerdict::Kind::ignored && selection.holds(range_of(frame, verdict)))
        verdicts.push_back(&verdict);
    people += count_people(frame, selection);
    ++frames;
  }
  void sort() {
    std::stable_sort(verdicts.begin(), verdicts.end(), [](const PersonVerdict* a, const PersonVerdict* b) {
      return a->person.probability > b->person.probability;
    });
  }
};

std::vector<ErrorPoint> curve_of(const Reports& reports) {
  std::vector<ErrorPoint> points;
  if (reports.people == 0) return points;
  int hits = 0, false_alarms = 0;
  for (std::size_t i = 0; i < reports.verdicts.size();) {
    const double probability = reports.verdicts[i]->person.probability;
    const int before = hits;
    // Reports of one probability are made together or not at all.
    for (; i < reports.verdicts.size() && reports.verdicts[i]->person.probability == probability; ++i)
      ++(reports.verdicts[i]->kind == PersonVerdict::Kind::hit ? hits : false_alarms);
    if (hits > before)
      points.push_back(
          {false_alarms / static_cast<double>(reports.frames), 1.0 - hits / static_cast<double>(reports.people)});
  }
  return points;
}

/// What is measured over the hits above the threshold.
struct HitErrors {
  std::vector<double> range, absolute_range, position_m;

  void add(const PersonVerdict& verdict) {
    position_m.push_back(verdict.position_error_m);
    if (!(verdict.near_range_m > 0.0)) return;
    range.push_back(verdict.range_error_m / verdict.near_range_m);
    absolute_range.push_back(std::abs(range.back()));
  }
};

void add_values(const Reports& reports, const Selection& selection, double threshold,
                std::map<MeasureKey, double>& values) {
  const auto put = [&](const char* name, std::optional<double> value) {
    if (value) values[{selection.group, selection.part, name}] = *value;
  };
  int hits = 0, false_alarms = 0;
  HitErrors errors;
  for (const auto* verdict : reports.verdicts) {
    if (!(verdict->person.probability > threshold)) break;
    const bool is_hit = verdict->kind == PersonVerdict::Kind::hit;
    ++(is_hit ? hits : false_alarms);
    if (is_hit) errors.add(*verdict);
  }
  if (reports.frames > 0) put("false_alarms_per_frame", false_alarms / static_cast<double>(reports.frames));
  if (reports.people > 0) {
    put("miss_rate", 1.0 - hits / static_cast<double>(reports.people));
    put("log_average_miss_rate", log_average_miss_rate(curve_of(reports), reports.people));
  }
  if (!errors.absolute_range.empty()) put("absolute_range_error_95", quantile(errors.absolute_range, 0.95));
  put("absolute_range_error", median(std::move(errors.absolute_range)));
  put("range_error", median(std::move(errors.range)));
  put("position_error_m", median(std::move(errors.position_m)));
}

Reports all_reports(std::span<const PeopleRun> runs) {
  Reports reports;
  for (const auto& run : runs)
    for (const auto& frame : run) reports.add(frame, {});
  reports.sort();
  return reports;
}

}  // namespace

PersonRole person_role(const LabelledObject& object, const PeopleOptions& options) {
  if (!is_person(object)) return PersonRole::other;
  const bool is_counted = object.type == "Pedestrian" && object.visible &&
                          object.box.height_px >= options.min_height_px &&
                          near_range_m(object.footprint) <= options.max_range_m;
  return is_counted ? PersonRole::counted : PersonRole::ignored;
}

double intersection_over_union(const ImageBox& a, const ImageBox& b) {
  const double both = intersection_px2(a, b), either = area_px2(a) + area_px2(b) - both;
  return either > 0.0 ? both / either : 0.0;
}

double people_overlap(const ImageBox& a, const ImageBox& b) {
  return intersection_over_union(standardised(a), standardised(b));
}

PeopleFrame score_people(const FrameTruth& truth, std::span<const Pedestrian> reports, const PeopleOptions& options) {
  PeopleFrame frame;
  for (const auto& object : truth.objects) {
    frame.roles.push_back(person_role(object, options));
    frame.ranges_m.push_back(near_range_m(object.footprint));
  }
  for (const auto& report : reports) {
    frame.verdicts.emplace_back();
    frame.verdicts.back().person = report;
  }
  std::stable_sort(frame.verdicts.begin(), frame.verdicts.end(), [](const PersonVerdict& a, const PersonVerdict& b) {
    return a.person.probability > b.person.probability;
  });
  std::vector<bool> taken(truth.objects.size(), false);
  for (auto& verdict : frame.verdicts) {
    const ImageBox box = standardised(verdict.person.box);
    verdict.object = best_person(truth, frame.roles, taken, box, options);
    if (verdict.object >= 0) {
      verdict.kind = PersonVerdict::Kind::hit;
      taken[static_cast<std::size_t>(verdict.object)] = true;
      measure_hit(truth, truth.objects[static_cast<std::size_t>(verdict.object)], verdict);
    } else if (is_ignored(truth, frame.roles, box)) {
      verdict.kind = PersonVerdict::Kind::ignored;
    }
  }
  return frame;
}

double log_average_miss_rate(std::span<const ErrorPoint> points, int people) {
  assert(people >= 1);
  constexpr int kReferences = 9;
  const double least = 0.5 / people;
  double sum = 0.0;
  for (int i = 0; i < kReferences; ++i) {
    const double false_alarms = std::pow(10.0, -2.0 + 2.0 * i / (kReferences - 1)) + kRoundingRange;
    double miss_rate = 1.0;
    for (const auto& point : points)
      if (point.false_positives <= false_alarms) miss_rate = std::min(miss_rate, point.miss_rate);
    sum += std::log(std::max(miss_rate, least));
  }
  return std::exp(sum / kReferences);
}

std::vector<ErrorPoint> people_curve(std::span<const PeopleRun> runs) { return curve_of(all_reports(runs)); }

ErrorPoint people_operating_point(std::span<const PeopleRun> runs, double threshold) {
  const Reports reports = all_reports(runs);
  ErrorPoint point{0.0, reports.people > 0 ? 1.0 : std::numeric_limits<double>::quiet_NaN()};
  for (const auto* verdict : reports.verdicts) {
    if (!(verdict->person.probability > threshold)) break;
    if (verdict->kind == PersonVerdict::Kind::hit)
      point.miss_rate -= 1.0 / reports.people;
    else
      point.false_positives += 1.0 / static_cast<double>(reports.frames);
  }
  return point;
}

std::map<MeasureKey, double> people_values(const PeopleRun& run, std::span<const std::size_t> frames, double threshold,
                                           const PeopleOptions& options) {
  std::map<MeasureKey, double> values;
  for (const auto& selection : selections(options)) {
    Reports reports;
    for (const std::size_t frame : frames) reports.add(run[frame], selection);
    reports.sort();
    add_values(reports, selection, threshold, values);
  }
  return values;
}

std::vector<std::pair<std::string, int>> people_by_range(const PeopleRun& run, const PeopleOptions& options) {
  std::vector<std::pair<std::string, int>> parts;
  for (const auto& selection : selections(options)) {
    if (selection.group == MeasureKey::Group::all) continue;
    int people = 0;
    for (const auto& frame : run) people += count_people(frame, selection);
    parts.emplace_back(selection.part, people);
  }
  return parts;
}

}  // namespace flies
