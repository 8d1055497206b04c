#include "flies/eval/evaluation.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "flies/io/pair_check.hpp"

namespace flies {
namespace {

/// Everything that is kept of a run.
struct RunRecord {
  std::vector<FrameScore> scores;
  std::vector<double> times_ms, evaluations;
};

double stage_ms(const Detection& detection, Stage stage) { return detection.stage_ms[static_cast<std::size_t>(stage)]; }

std::vector<MissedInRuns> missed_objects(const std::vector<FrameTruth>& truths, const std::vector<RunRecord>& runs) {
  std::vector<MissedInRuns> missed;
  for (std::size_t f = 0; f < truths.size(); ++f) {
    for (std::size_t i = 0; i < truths[f].objects.size(); ++i) {
      const auto count = std::count_if(runs.begin(), runs.end(), [&](const RunRecord& run) {
        return run.scores[f].objects[i].counted && !run.scores[f].objects[i].found;
      });
      if (count > 0) missed.push_back({truths[f].name, truths[f].objects[i], static_cast<int>(count)});
    }
  }
  return missed;
}

MethodResult judge(const std::string& name, const std::vector<FrameTruth>& truths, const std::vector<RunRecord>& runs,
                   const EstimateOptions& options) {
  MethodResult result;
  result.name = name;
  result.runs = static_cast<int>(runs.size());
  std::vector<std::vector<FrameScore>> scores;
  std::vector<double> times_ms, evaluations;
  for (const auto& run : runs) {
    scores.push_back(run.scores);
    times_ms.insert(times_ms.end(), run.times_ms.begin(), run.times_ms.end());
    evaluations.insert(evaluations.end(), run.evaluations.begin(), run.evaluations.end());
  }
  result.estimates = estimate_measures(truths, scores, options);
  result.time_ms = median(std::move(times_ms));
  if (!evaluations.empty())
    result.evaluations =
        std::accumulate(evaluations.begin(), evaluations.end(), 0.0) / static_cast<double>(evaluations.size());
  result.missed = missed_objects(truths, runs);
  return result;
}

/// No method can change which objects are to be found, so an empty report will do to count them.
void count_objects(const std::vector<FrameTruth>& truths, const MatchOptions& match, Evaluation& evaluation) {
  std::vector<FrameScore> scores;
  for (const auto& truth : truths) scores.push_back(score_frame(truth, {}, match));
  const Measures measures = summarize(truths, scores);
  evaluation.objects = measures.all.recall.total;
  for (const auto& part : measures.by_class) evaluation.by_class.push_back({part.name, part.accuracy.recall.total});
  for (const auto& part : measures.by_range) evaluation.by_range.push_back({part.name, part.accuracy.recall.total});
}

}  // namespace

Method flies_method(const std::string& name, const DetectorOptions& options, int seeds,
                    std::shared_ptr<const PeopleClassifier> classifier, bool is_sequence) {
  Method method{name, {}};
  for (int i = 0; i < seeds; ++i) {
    DetectorOptions of_run = options;
    of_run.seed += static_cast<std::uint64_t>(i);
    // Shared, because copies of a function must not go on from different pairs.
    const auto detector = std::make_shared<std::optional<Detector>>();
    method.runs.push_back([=](std::size_t, const TruthFrame& frame) {
      if (!*detector || !is_sequence) detector->emplace(frame.camera, of_run, classifier);
      const Detection d = (*detector)->process(frame.images.view());
      return Findings{d.obstacles,
                      stage_ms(d, Stage::road) + stage_ms(d, Stage::evolve) + stage_ms(d, Stage::concentrate),
                      static_cast<double>(d.evolved.evaluations)};
    });
  }
  return method;
}

Method dense_method(DenseMatcher matcher, const DetectorOptions& options, const DenseOptions& dense) {
  const std::string name(EnumNames<DenseMatcher>::names[static_cast<std::size_t>(matcher)]);
  return {name, {[=](std::size_t, const TruthFrame& frame) {
            DenseDetection found = detect_densely(frame.images.view(), frame.camera, matcher, options, dense);
            return Findings{std::move(found.obstacles), found.road_ms + found.match_ms + found.concentrate_ms, {}};
          }}};
}

Method reported_method(const std::string& name, std::vector<std::vector<ReportedFrame>> runs) {
  Method method{name, {}};
  for (auto& run : runs)
    method.runs.push_back([frames = std::move(run)](std::size_t pair, const TruthFrame&) {
      return Findings{frames[pair].obstacles, frames[pair].time_ms, {}};
    });
  return method;
}

Evaluation evaluate(const Dataset& dataset, std::span<const std::size_t> frames, const std::vector<Method>& methods,
                    const MatchOptions& match, const EstimateOptions& estimate,
                    const std::function<void(std::size_t)>& progress) {
  Evaluation evaluation;
  evaluation.frames = frames.size();
  std::vector<FrameTruth> truths;
  std::vector<std::vector<RunRecord>> records;
  for (const auto& method : methods) records.emplace_back(method.runs.size());
  for (const std::size_t pair : frames) {
    TruthFrame frame = dataset.load(pair);
    if (truths.empty())
      check_true_pair(frame.images.view(), frame.camera, dataset.pairs[pair].left, dataset.pairs[pair].right);
    for (std::size_t m = 0; m < methods.size(); ++m) {
      for (std::size_t r = 0; r < methods[m].runs.size(); ++r) {
        const Findings findings = methods[m].runs[r](pair, frame);
        RunRecord& record = records[m][r];
        record.scores.push_back(score_frame(frame.truth, findings.obstacles, match));
        if (findings.time_ms) record.times_ms.push_back(*findings.time_ms);
        if (findings.evaluations) record.evaluations.push_back(*findings.evaluations);
      }
    }
    evaluation.frames_with_lidar += !frame.truth.lidar.empty();
    frame.truth.lidar = {};  // scored already, and large
    truths.push_back(std::move(frame.truth));
    if (progress) progress(truths.size());
  }
  count_objects(truths, match, evaluation);
  for (std::size_t m = 0; m < methods.size(); ++m)
    evaluation.methods.push_back(judge(methods[m].name, truths, records[m], estimate));
  return evaluation;
}

}  // namespace flies
