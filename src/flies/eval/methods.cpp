// What is measured: the detector, and what is held against it.
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <numeric>
#include <utility>

#include "flies/eval/evaluation.hpp"

namespace flies {
namespace {

/// Of the curves of scans.
constexpr std::array kScanPoints = {5, 10, 25, 60, 120};
constexpr std::array kScanConfidences = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95};

/// Below the threshold of any model by more than its log-odds reach.
constexpr double kAllVerdicts = 100.0;

/// Where the search of the whole image gives up: dozens of false alarms a pair.
constexpr double kLeastProbability = 0.15;

double stage_ms(const Detection& detection, Stage stage) { return detection.stage_ms[static_cast<std::size_t>(stage)]; }

/// With the curve over the least confidence; nothing for an empty scan.
std::optional<ScanFindings> scan_findings(const Scan& scan) {
  if (scan.empty()) return std::nullopt;
  ScanFindings findings{scan};
  for (const double confidence : kScanConfidences)
    findings.by_setting.emplace_back(confidence, with_min_confidence(scan, confidence));
  return findings;
}

}  // namespace

Method flies_method(const std::string& name, const DetectorOptions& options, int seeds,
                    std::shared_ptr<const PeopleClassifier> classifier, bool is_sequence,
                    const EvaluationOptions& measuring) {
  Method method{name, {}};
  method.scan_setting = "min_confidence";
  method.people_threshold = report_threshold(*classifier, options.classify);
  ClassifyOptions for_curve = options.classify;
  for_curve.threshold_offset = for_curve.one_stage_threshold_offset = -kAllVerdicts;
  for (int i = 0; i < seeds; ++i) {
    DetectorOptions of_run = options;
    of_run.seed += static_cast<std::uint64_t>(i);
    // Shared, because copies of a function must not go on from different pairs.
    const auto detector = std::make_shared<std::optional<Detector>>();
    method.runs.push_back([=](std::size_t, const TruthFrame& frame) {
      if (!*detector || !is_sequence) detector->emplace(frame.camera, of_run, classifier);
      const Detection d = (*detector)->process(frame.images.view());
      // The surest verdict is kept first, so that more of them below the threshold change none above it.
      PeopleFindings people{find_people(frame.images.left.view(), d.rois, *classifier, for_curve).pedestrians,
                            std::accumulate(d.stage_ms.begin(), d.stage_ms.end(), 0.0)};
      people.trail = follow_people(frame.truth, frame.camera, d, people.people,
                                   first_look_threshold(*classifier, options.classify),
                                   report_threshold(*classifier, options.classify), measuring.people, measuring.match);
      return Findings{d.obstacles,
                      stage_ms(d, Stage::road) + stage_ms(d, Stage::evolve) + stage_ms(d, Stage::scan) +
                          stage_ms(d, Stage::concentrate),
                      static_cast<double>(d.evolved.evaluations), std::move(people), scan_findings(d.scan)};
    });
  }
  return method;
}

Method dense_method(DenseMatcher matcher, const DetectorOptions& options, const DenseOptions& dense,
                    const EvaluationOptions& measuring) {
  Method method{std::string(enum_name(matcher)), {}};
  method.scan_setting = "scan_points";
  method.runs.push_back([=](std::size_t, const TruthFrame& frame) {
    DenseDetection found = detect_densely(frame.images.view(), frame.camera, matcher, options, dense, measuring.match,
                                          measuring.sectors.increment_deg);
    ScanFindings scan{dense_scan(found.ranges, dense.scan_points, dense)};
    for (const int points : kScanPoints) scan.by_setting.emplace_back(points, dense_scan(found.ranges, points, dense));
    return Findings{
        std::move(found.obstacles), found.road_ms + found.match_ms + found.concentrate_ms, {}, {}, std::move(scan)};
  });
  return method;
}

Method hog_method(HogDetector detector, const HogOptions& hog) {
  Method method{std::string(enum_name(detector)), {}};
  method.finds_obstacles = false;
  method.people_threshold = hog_model(detector).threshold;
  method.runs.push_back([=](std::size_t, const TruthFrame& frame) {
    PeopleSearch found = detect_people_by_hog(frame.images.left.view(), frame.camera, detector, kLeastProbability, hog);
    return Findings{{}, {}, {}, PeopleFindings{std::move(found.people), found.time_ms}};
  });
  return method;
}

Method network_method(const std::string& weights_file, const NetworkSearchOptions& options) {
  Method method{std::filesystem::path(weights_file).stem().string(), {}};
  method.finds_obstacles = false;
  method.people_threshold = options.threshold;
  const auto search = std::make_shared<NetworkSearch>(weights_file, options);
  method.runs.push_back([=](std::size_t, const TruthFrame& frame) {
    PeopleSearch found =
        search->detect(frame.images.left.view(), frame.camera, std::min(kLeastProbability, options.threshold));
    return Findings{{}, {}, {}, PeopleFindings{std::move(found.people), found.time_ms}};
  });
  return method;
}

Method reported_method(const std::string& name, std::vector<std::vector<ReportedFrame>> runs) {
  Method method{name, {}};
  method.scan_setting = "min_confidence";
  for (auto& run : runs)
    method.runs.push_back([frames = std::move(run)](std::size_t pair, const TruthFrame&) {
      const ReportedFrame& frame = frames[pair];
      Findings findings{frame.obstacles, frame.time_ms, {}, {}};
      if (frame.scan) findings.scan = scan_findings(*frame.scan);
      if (frame.pedestrians) findings.people = PeopleFindings{*frame.pedestrians, frame.people_time_ms};
      return findings;
    });
  return method;
}

}  // namespace flies
