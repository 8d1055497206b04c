#include "tests/blackbox/blackbox.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "flies/core/quantile.hpp"
#include "flies/eval/people.hpp"
#include "flies/io/images.hpp"

namespace flies::blackbox {
namespace {

std::string percent(std::optional<double> value) { return value ? fmt::format("{:+.1f} %", 100.0 * *value) : "-"; }
std::string percent(const Rate& rate) {
  return rate.total > 0 ? fmt::format("{:.1f} % ({}/{})", 100.0 * *rate.value(), rate.hits, rate.total) : "-";
}

}  // namespace

ScoredFrame detect_and_score(Detector& detector, const std::filesystem::path& left, const std::filesystem::path& right,
                             FrameTruth truth, const MatchOptions& options) {
  const GrayPair pair = load_pair(left.string(), right.string());
  ScoredFrame frame;
  frame.truth = std::move(truth);
  frame.detection = detector.process(pair.view());
  frame.score = score_frame(frame.truth, frame.detection.obstacles, options);
  return frame;
}

PeopleCount count_people(const std::vector<ScoredFrame>& frames) {
  PeopleCount count;
  for (const auto& frame : frames) {
    const PeopleFrame people = score_people(frame.truth, frame.detection.pedestrians);
    count.wanted += static_cast<int>(std::count(people.roles.begin(), people.roles.end(), PersonRole::counted));
    for (const auto& verdict : people.verdicts) {
      count.found += verdict.kind == PersonVerdict::Kind::hit;
      count.false_alarms += verdict.kind == PersonVerdict::Kind::false_alarm;
    }
  }
  fmt::print("\npeople: {} of {} found, {} false alarms in {} pairs\n", count.found, count.wanted, count.false_alarms,
             frames.size());
  return count;
}

std::vector<ObjectRow> tabulate(const std::vector<ScoredFrame>& frames) {
  std::map<std::string, ObjectRow> rows;
  for (const auto& frame : frames) {
    for (std::size_t i = 0; i < frame.truth.objects.size(); ++i) {
      if (!frame.score.objects[i].counted) continue;
      const auto& object = frame.truth.objects[i];
      ObjectRow& row = rows[fmt::format("{} {}", object.type, object.track)];
      row.name = fmt::format("{} {}", object.type, object.track);
      ++row.in_view;
      row.found += frame.score.objects[i].found;
      if (!frame.score.objects[i].found) row.missed_in.push_back(frame.truth.name);
      for (const auto& verdict : frame.score.obstacles) {
        if (verdict.object == static_cast<int>(i)) {
          row.range_errors.push_back(verdict.range_error_m / verdict.near_range_m);
        }
      }
    }
  }
  std::vector<ObjectRow> ordered;
  for (auto& entry : rows) ordered.push_back(std::move(entry.second));
  return ordered;
}

void print_table(const std::string& title, const std::vector<ObjectRow>& rows) {
  fmt::print("\n{}\n{:<16} {:>8} {:>6} {:>12}  {}\n", title, "object", "in view", "found", "range error", "missed in");
  for (const auto& row : rows) {
    fmt::print("{:<16} {:>8} {:>6} {:>12}  {}\n", row.name, row.in_view, row.found, percent(median(row.range_errors)),
               fmt::join(row.missed_in, " "));
  }
}

Measures print_summary(const std::vector<ScoredFrame>& frames) {
  std::vector<FrameTruth> truths;
  std::vector<FrameScore> scores;
  for (const auto& frame : frames) {
    truths.push_back(frame.truth);
    scores.push_back(frame.score);
  }
  const Measures measures = summarize(truths, scores);
  fmt::print("recall {}, precision {}, range error {}, obstacles a frame {:.1f}\n", percent(measures.all.recall),
             percent(measures.all.precision), percent(measures.all.range_error), measures.obstacles_per_frame);
  return measures;
}

}  // namespace flies::blackbox
