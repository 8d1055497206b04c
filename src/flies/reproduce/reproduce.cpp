#include "flies/reproduce/reproduce.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "flies/core/error.hpp"

namespace flies {
namespace {

constexpr double kPaperPerson_m = 15.52;  // x of the pedestrian of the paper's figure 3
constexpr double kAlone_m = 15.5;

constexpr double kPercent = 100.0;

using Value = std::optional<double>;

Value ratio(const Value& numerator, const Value& denominator) {
  if (!numerator || !denominator || !(*denominator > 0.0)) return std::nullopt;
  return *numerator / *denominator;
}
Value size(const std::optional<LocalizationError>& error, double LocalizationError::*field) {
  if (!error) return std::nullopt;
  return std::abs(*error.*field);
}
Value percent_of(const Value& error, double range_m) {
  if (!error) return std::nullopt;
  return kPercent * std::abs(*error) / range_m;
}

// The paper: (15.52, -1.10), then (14.50, -0.94) after sampling and (15.43, -1.13) after mean shift.
constexpr std::array<ExperimentRow, 12> kRows = {{
    {"rms_eq2_m", "RMS distance of fitness to the person, Eq. (2)", "m", 2, 2.94, true,
     [](const PersonPlace&, const PersonRun& r) { return r.rms_covariance_m; }},
    {"rms_eq1_m", "RMS distance of fitness to the person, Eq. (1)", "m", 2, 6.86, false,
     [](const PersonPlace&, const PersonRun& r) { return r.rms_louchet_m; }},
    {"rms_ratio", "their ratio, Eq. (2) / Eq. (1)", "", 2, 0.43, true,
     [](const PersonPlace&, const PersonRun& r) { return ratio(r.rms_covariance_m, r.rms_louchet_m); }},
    {"rms_ratio_without_others", "their ratio, flies at other things left out", "", 2, std::nullopt, true,
     [](const PersonPlace&, const PersonRun& r) { return ratio(r.rms_covariance_alone_m, r.rms_louchet_alone_m); }},
    {"spread_sample_error_m", "not evolved: error along x after sampling", "m", 2, 1.02, true,
     [](const PersonPlace&, const PersonRun& r) { return size(r.spread, &LocalizationError::sample_x_m); }},
    {"spread_shift_error_m", "not evolved: error along x after mean shift", "m", 2, 0.09, true,
     [](const PersonPlace&, const PersonRun& r) { return size(r.spread, &LocalizationError::shifted_x_m); }},
    {"evolved_sample_error_m", "evolved: error along x after sampling", "m", 2, 1.02, true,
     [](const PersonPlace&, const PersonRun& r) { return size(r.evolved, &LocalizationError::sample_x_m); }},
    {"evolved_shift_error_m", "evolved: error along x after mean shift", "m", 2, 0.09, true,
     [](const PersonPlace&, const PersonRun& r) { return size(r.evolved, &LocalizationError::shifted_x_m); }},
    {"evolved_shift_error_percent", "evolved: the latter, share of range", "%", 1, kPercent * 0.09 / 15.56, true,
     [](const PersonPlace& p, const PersonRun& r) {
       return percent_of(size(r.evolved, &LocalizationError::shifted_x_m), p.range_m());
     }},
    {"evolved_shift_error_middle_percent", "evolved: the same against the middle of the person", "%", 1, std::nullopt,
     true,
     [](const PersonPlace& p, const PersonRun& r) -> Value {
       if (!r.evolved) return std::nullopt;
       return percent_of(r.evolved->shifted_x_m + p.near.x_m - p.middle.x_m, p.range_m());
     }},
    {"obstacle_error_percent", "evolved: range error of the person's OOI", "%", 1, std::nullopt, true,
     [](const PersonPlace& p, const PersonRun& r) { return percent_of(r.obstacle_range_m, p.range_m()); }},
    {"missed_percent", "evolved: people without an OOI", "%", 0, std::nullopt, true, nullptr},
}};

/// For each seed one value over people, then their spread.
std::optional<Spread> over_seeds(const std::vector<MeasuredPerson>& people, const ExperimentRow& measure) {
  std::vector<Value> per_seed;
  for (std::size_t seed = 0; seed < people.front().experiment.runs.size(); ++seed) {
    std::vector<Value> values;
    std::size_t missed = 0;
    for (const auto& [frame, e] : people) {
      if (measure.value) values.push_back(measure.value(e.person, e.runs[seed]));
      missed += e.runs[seed].obstacle_range_m ? 0 : 1;
    }
    if (!measure.value) {
      per_seed.emplace_back(kPercent * static_cast<double>(missed) / static_cast<double>(people.size()));
    } else if (const auto spread = spread_of(values)) {
      per_seed.emplace_back(spread->median);
    }
  }
  return spread_of(per_seed);
}

Timing time_method(const LabelledFrame& frame, const PersonOptions& options) {
  constexpr int kRuns = 9;
  Timing timing;
  timing.frame = frame.name;
  timing.runs = kRuns;
  timing.threads = options.method.threads;
  std::array<std::vector<Value>, kStageCount> stage_ms;
  for (int run = -1; run < kRuns; ++run) {
    // A detector of its own for each run: all do the same work.
    Detector detector(frame.camera, options.method);
    const Detection detection = detector.process(frame.images.view());
    timing.evaluations = detection.evolved.evaluations;
    if (run < 0) continue;
    for (std::size_t stage = 0; stage < kStageCount; ++stage) stage_ms[stage].emplace_back(detection.stage_ms[stage]);
  }
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    timing.median_ms[stage] = spread_of(stage_ms[stage])->median;
  return timing;
}

std::size_t nearest_to_paper(const std::vector<MeasuredPerson>& people) {
  const auto unlike = [](const MeasuredPerson& p) { return std::abs(p.experiment.person.range_m() - kPaperPerson_m); };
  const auto best = std::min_element(people.begin(), people.end(),
                                     [&](const auto& a, const auto& b) { return unlike(a) < unlike(b); });
  return static_cast<std::size_t>(best - people.begin());
}

}  // namespace

std::span<const ExperimentRow> experiment_rows() { return kRows; }

std::vector<FrameSet> embedded_sets(int scenes, const std::function<void(std::size_t)>& progress) {
  FrameSet alone{
      "one person", fmt::format("A person alone on a road, {:g} m ahead, as in the paper's figure 3.", kAlone_m), {}};
  FrameSet street{"street", "A town street with people, cars, poles, trees and house fronts.", {}};
  std::size_t done = 0;
  for (int i = 0; i < scenes; ++i) {
    SceneOptions options;
    options.seed = 1 + static_cast<std::uint64_t>(i);
    street.frames.push_back(render_labelled_frame(options, fmt::format("street, seed {}", options.seed)));
    if (progress) progress(++done);
    options.kind = SceneKind::pedestrian;
    options.people_min_range_m = kAlone_m;
    alone.frames.push_back(render_labelled_frame(options, fmt::format("one person, seed {}", options.seed)));
    if (progress) progress(++done);
  }
  return {std::move(alone), std::move(street)};
}

std::size_t count_people(const FrameSet& set, const MatchOptions& match) {
  std::size_t count = 0;
  for (const auto& frame : set.frames) count += people_in(frame.truth, match).size();
  return count;
}

SetResult reproduce(const FrameSet& set, const PersonOptions& options,
                    const std::function<void(std::size_t)>& progress) {
  SetResult result;
  for (std::size_t i = 0; i < set.frames.size(); ++i) {
    const auto& frame = set.frames[i];
    for (const auto& person : people_in(frame.truth, options.match)) {
      result.people.push_back({i, measure_person(frame.images.view(), frame.camera, person, options)});
      if (progress) progress(result.people.size());
    }
  }
  if (result.people.empty()) throw InputError(set.title, "", "no frame shows a labelled person that counts");
  for (const auto& measure : experiment_rows()) result.rows.push_back(over_seeds(result.people, measure));
  result.shown = nearest_to_paper(result.people);
  result.timing = time_method(set.frames[result.people[result.shown].frame], options);
  return result;
}

}  // namespace flies
