#include "flies/eval/evaluation.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "flies/core/pair_check.hpp"
#include "flies/core/quantile.hpp"

namespace flies {
namespace {

/// Everything that is kept of a run.
struct RunRecord {
  std::vector<FrameScore> scores;
  std::vector<double> times_ms, evaluations;
  PeopleRun people;  ///< empty when it does not look for them
  std::vector<double> people_times_ms;
  std::vector<PeopleTrail> trails;         ///< a pair each; fewer when it does not tell
  std::vector<ScanScore> scans;            ///< a pair each; fewer when some pairs have no scan
  std::map<double, ScanScore> by_setting;  ///< all pairs
};

/// The objects for which `is_missed(run, frame, object)` holds in any of the runs, and in how many.
template <class Run, class IsMissed>
std::vector<MissedInRuns> missed_in_runs(const std::vector<FrameTruth>& truths, const std::vector<Run>& runs,
                                         IsMissed is_missed) {
  std::vector<MissedInRuns> missed;
  for (std::size_t f = 0; f < truths.size(); ++f) {
    for (std::size_t i = 0; i < truths[f].objects.size(); ++i) {
      const auto count = std::count_if(runs.begin(), runs.end(), [&](const Run& run) { return is_missed(run, f, i); });
      if (count > 0) missed.push_back({truths[f].name, i, truths[f].objects[i], static_cast<int>(count)});
    }
  }
  return missed;
}

std::vector<MissedInRuns> missed_objects(const std::vector<FrameTruth>& truths, const std::vector<RunRecord>& runs) {
  return missed_in_runs(truths, runs, [](const RunRecord& run, std::size_t frame, std::size_t object) {
    const auto& verdict = run.scores[frame].objects[object];
    return verdict.counted && !verdict.found;
  });
}

std::vector<MissedInRuns> missed_people(const std::vector<FrameTruth>& truths, const std::vector<PeopleRun>& runs,
                                        double threshold) {
  return missed_in_runs(truths, runs, [&](const PeopleRun& run, std::size_t frame, std::size_t object) {
    const auto& verdicts = run[frame].verdicts;
    return run[frame].roles[object] == PersonRole::counted &&
           std::none_of(verdicts.begin(), verdicts.end(), [&](const PersonVerdict& verdict) {
             return verdict.object == static_cast<int>(object) && verdict.person.probability > threshold;
           });
  });
}

/// Adds where each was lost.
void add_stages(const std::vector<FrameTruth>& truths, const std::vector<RunRecord>& records,
                std::vector<MissedInRuns>& missed) {
  for (auto& person : missed)
    for (std::size_t f = 0; f < truths.size(); ++f) {
      if (truths[f].name != person.frame_name) continue;
      for (const auto& record : records)
        for (const auto& path : record.trails[f].paths)
          person.stages[static_cast<std::size_t>(path.stage)] +=
              path.stage != PersonStage::found && path.object == person.index;
    }
}

std::vector<FalseAlarm> false_alarms(const std::vector<FrameTruth>& truths, const PeopleRun& run, double threshold) {
  std::vector<FalseAlarm> listed;
  for (std::size_t f = 0; f < truths.size(); ++f)
    for (const auto& verdict : run[f].verdicts)
      if (verdict.kind == PersonVerdict::Kind::false_alarm && verdict.person.probability > threshold)
        listed.push_back({truths[f].name, verdict.person});
  return listed;
}

/// Nothing when the method does not look for people.
std::optional<PeopleResult> judge_people(double threshold, const std::vector<FrameTruth>& truths,
                                         const std::vector<RunRecord>& records, const EvaluationOptions& options) {
  std::vector<PeopleRun> runs;
  std::vector<double> times_ms;
  for (const auto& record : records) {
    if (record.people.size() != truths.size()) return std::nullopt;
    runs.push_back(record.people);
    times_ms.insert(times_ms.end(), record.people_times_ms.begin(), record.people_times_ms.end());
  }
  PeopleResult result;
  result.estimates = estimate_values(
      truths.size(), runs.size(),
      [&](std::size_t run, std::span<const std::size_t> frames) {
        return people_values(runs[run], frames, threshold, options.people);
      },
      options.estimate);
  result.curve = people_curve(runs);
  result.operating_point = people_operating_point(runs, threshold);
  result.time_ms = median(std::move(times_ms));
  result.missed = missed_people(truths, runs, threshold);
  result.false_alarms = false_alarms(truths, runs.front(), threshold);
  std::vector<PeopleTrail> trails;
  for (const auto& record : records) std::ranges::copy(record.trails, std::back_inserter(trails));
  if (trails.size() == truths.size() * records.size()) {
    add_stages(truths, records, result.missed);
    result.losses = sum_up(trails);
  }
  return result;
}

/// Nothing when the method has no scan, or no sector is judged.
std::optional<ScanResult> judge_scan(const Method& method, std::size_t frames, const std::vector<RunRecord>& runs,
                                     const EvaluationOptions& options) {
  std::map<double, ScanScore> by_setting;
  for (const auto& run : runs) {
    if (run.scans.size() != frames) return std::nullopt;
    for (const auto& [setting, score] : run.by_setting) by_setting[setting] += score;
  }
  ScanResult result;
  result.estimates = estimate_values(
      frames, runs.size(),
      [&](std::size_t run, std::span<const std::size_t> some) { return scan_values(runs[run].scans, some); },
      options.estimate);
  if (result.estimates.empty()) return std::nullopt;
  result.setting = method.scan_setting;
  constexpr std::size_t kAll = 0;
  for (const auto& [setting, score] : by_setting)
    result.curve.push_back({setting, scan_values(std::span(&score, 1), std::span(&kAll, 1))});
  return result;
}

void record_scan(const ScanFindings& found, const ScanTruth& truth, const EvaluationOptions& options,
                 RunRecord& record) {
  record.scans.push_back(score_scan(truth, found.scan, options.match, options.sectors));
  for (const auto& [setting, scan] : found.by_setting)
    record.by_setting[setting] += score_scan(truth, scan, options.match, options.sectors);
}

MethodResult judge(const Method& method, const std::vector<FrameTruth>& truths, const std::vector<RunRecord>& runs,
                   const EvaluationOptions& options) {
  MethodResult result;
  result.name = method.name;
  result.runs = static_cast<int>(runs.size());
  result.finds_obstacles = method.finds_obstacles;
  result.people = judge_people(method.people_threshold, truths, runs, options);
  result.scan = judge_scan(method, truths.size(), runs, options);
  if (!method.finds_obstacles) return result;
  std::vector<std::vector<FrameScore>> scores;
  std::vector<double> times_ms, evaluations;
  for (const auto& run : runs) {
    scores.push_back(run.scores);
    times_ms.insert(times_ms.end(), run.times_ms.begin(), run.times_ms.end());
    evaluations.insert(evaluations.end(), run.evaluations.begin(), run.evaluations.end());
  }
  result.estimates = estimate_measures(truths, scores, options.estimate);
  result.time_ms = median(std::move(times_ms));
  if (!evaluations.empty())
    result.evaluations =
        std::accumulate(evaluations.begin(), evaluations.end(), 0.0) / static_cast<double>(evaluations.size());
  result.missed = missed_objects(truths, runs);
  return result;
}

/// No method can change which objects are to be found, so an empty report will do to count them.
void count_objects(const std::vector<FrameTruth>& truths, const EvaluationOptions& options, Evaluation& evaluation) {
  std::vector<FrameScore> scores;
  PeopleRun people;
  for (const auto& truth : truths) {
    scores.push_back(score_frame(truth, {}, options.match));
    people.push_back(score_people(truth, {}, options.people));
  }
  const Measures measures = summarize(truths, scores);
  evaluation.objects = measures.all.recall.total;
  for (const auto& part : measures.by_class) evaluation.by_class.push_back({part.name, part.accuracy.recall.total});
  for (const auto& part : measures.by_range) evaluation.by_range.push_back({part.name, part.accuracy.recall.total});
  for (const auto& [name, count] : people_by_range(people, options.people)) {
    evaluation.people_by_range.push_back({name, count});
    evaluation.people += count;
  }
}

}  // namespace

Evaluation evaluate(const Dataset& dataset, std::span<const std::size_t> frames, const std::vector<Method>& methods,
                    const EvaluationOptions& options, const std::function<void(std::size_t)>& progress) {
  Evaluation evaluation;
  evaluation.frames = frames.size();
  std::vector<FrameTruth> truths;
  std::vector<std::vector<RunRecord>> records;
  for (const auto& method : methods) records.emplace_back(method.runs.size());
  for (const std::size_t pair : frames) {
    TruthFrame frame = dataset.load(pair);
    check_true_pair(frame.images.view(), frame.camera, dataset.pairs[pair].left, dataset.pairs[pair].right);
    const ScanTruth sectors = scan_truth(frame.truth, frame.camera, options.match, options.sectors);
    evaluation.sectors += score_scan(sectors, {}, options.match, options.sectors);
    for (std::size_t m = 0; m < methods.size(); ++m) {
      for (std::size_t r = 0; r < methods[m].runs.size(); ++r) {
        const Findings findings = methods[m].runs[r](pair, frame);
        RunRecord& record = records[m][r];
        record.scores.push_back(score_frame(frame.truth, findings.obstacles, options.match));
        if (findings.time_ms) record.times_ms.push_back(*findings.time_ms);
        if (findings.evaluations) record.evaluations.push_back(*findings.evaluations);
        if (findings.scan) record_scan(*findings.scan, sectors, options, record);
        if (!findings.people) continue;
        record.people.push_back(score_people(frame.truth, findings.people->people, options.people));
        if (findings.people->trail) record.trails.push_back(*findings.people->trail);
        if (findings.people->time_ms) record.people_times_ms.push_back(*findings.people->time_ms);
      }
    }
    evaluation.frames_with_lidar += !frame.truth.lidar.empty();
    frame.truth.lidar = frame.truth.map = {};  // scored already, and large
    truths.push_back(std::move(frame.truth));
    if (progress) progress(truths.size());
  }
  count_objects(truths, options, evaluation);
  for (std::size_t m = 0; m < methods.size(); ++m)
    evaluation.methods.push_back(judge(methods[m], truths, records[m], options));
  return evaluation;
}

}  // namespace flies
