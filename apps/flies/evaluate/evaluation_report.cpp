#include "evaluate/evaluation_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/draw/curves.hpp"
#include "shared/report_json.hpp"

namespace {

using flies::Estimate;
using flies::Evaluation;
using flies::MeasureKey;
using flies::MethodResult;
using Group = MeasureKey::Group;
using Json = nlohmann::ordered_json;

constexpr int kLabelWidth = 34, kColumnWidth = 30;

/// How a measure is written.
struct Style {
  double scale = 1.0;
  int decimals = 3;
  bool has_sign = false;
};
constexpr Style kShare{1.0, 3, false};
constexpr Style kPercent{100.0, 2, false};
constexpr Style kSignedPercent{100.0, 2, true};
constexpr Style kMetres{1.0, 2, false};
constexpr Style kSignedMetres{1.0, 2, true};
constexpr Style kCount{1.0, 1, false};

struct Row {
  const char* label;
  const char* measure;
  Style style;
};
constexpr Row kRows[] = {
    {"precision against lidar", "precision", kShare},
    {"precision against labels", "label_precision", kShare},
    {"recall, labelled objects", "recall", kShare},
    {"recall, people to 30 m", "people_recall", kShare},
    {"range error, median |.| [%]", "absolute_range_error", kPercent},
    {"range error, median signed [%]", "range_error", kSignedPercent},
    {"width error, median |.| [m]", "absolute_width_error_m", kMetres},
    {"width error, median signed [m]", "width_error_m", kSignedMetres},
    {"width error, seen whole, |.| [m]", "whole_width_error_m", kMetres},
    {"depth error, median |.| [m]", "absolute_depth_error_m", kMetres},
    {"depth error, median signed [m]", "depth_error_m", kSignedMetres},
    {"depth error, seen whole, |.| [m]", "whole_depth_error_m", kMetres},
    {"height error, median |.| [m]", "absolute_height_error_m", kMetres},
    {"height error, median signed [m]", "height_error_m", kSignedMetres},
    {"obstacles a pair", "obstacles_per_frame", kCount},
    {"reports a found object", "reports_per_found_object", kMetres},
};
constexpr Row kPartRows[] = {
    {"recall", "recall", kShare},
    {"precision against lidar", "precision", kShare},
    {"precision against labels", "label_precision", kShare},
    {"range error, median |.| [%]", "absolute_range_error", kPercent},
    {"range error, median signed [%]", "range_error", kSignedPercent},
    {"width error, median |.| [m]", "absolute_width_error_m", kMetres},
    {"height error, median |.| [m]", "absolute_height_error_m", kMetres},
};
constexpr Row kPeopleRows[] = {
    {"log-average miss rate", "log_average_miss_rate", kShare},
    {"miss rate at the threshold", "miss_rate", kShare},
    {"false alarms a pair", "false_alarms_per_frame", kMetres},
    {"range error, median |.| [%]", "absolute_range_error", kPercent},
    {"range error, 95 % of |.| [%]", "absolute_range_error_95", kPercent},
    {"range error, median signed [%]", "range_error", kSignedPercent},
    {"position error, median [m]", "position_error_m", kMetres},
};

constexpr Row kScanRows[] = {
    {"right", "right", kShare},
    {"blind", "blind", kShare},
    {"ghost", "ghost", kShare},
    {"unknown", "unknown", kShare},
    {"blind, nearer than {:g} m", "near_blind", kShare},
    {"ghosts in open sectors", "open_ghost", kShare},
    {"range error, median |.| [%]", "absolute_range_error", kPercent},
    {"range error, median signed [%]", "range_error", kSignedPercent},
};

std::string number(double value, const Style& style) {
  const double scaled = value * style.scale;
  return style.has_sign ? fmt::format("{:+.{}f}", scaled, style.decimals)
                        : fmt::format("{:.{}f}", scaled, style.decimals);
}

using Estimates = std::map<MeasureKey, Estimate>;

/// "0.981 (0.970..0.990) ~0.004": median, interval over frames, spread over seeds.
std::string cell(const Estimates& estimates, int runs, const MeasureKey& key, const Style& style, bool with_interval) {
  const auto found = estimates.find(key);
  if (found == estimates.end()) return "-";
  const Estimate& estimate = found->second;
  std::string text = number(estimate.median, style);
  if (with_interval && estimate.low && estimate.high)
    text += fmt::format(" ({}..{})", number(*estimate.low, style), number(*estimate.high, style));
  if (with_interval && runs > 1) text += " ~" + number(estimate.spread, {style.scale, style.decimals, false});
  return text;
}

/// A line with a cell a method; empty when no method has one.
std::string line(const Evaluation& evaluation, const std::string& label,
                 const std::function<std::string(const MethodResult&)>& cell_of) {
  std::string text = fmt::format("{:<{}}", label, kLabelWidth);
  bool is_empty = true;
  for (const auto& method : evaluation.methods) {
    const std::string content = cell_of(method);
    is_empty = is_empty && content == "-";
    text += fmt::format(" {:<{}}", content, kColumnWidth);
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return is_empty ? "" : text + "\n";
}

/// The part as a heading, then its measures without intervals.
std::string part_lines(const Evaluation& evaluation, Group group, const std::string& part, int objects) {
  std::string text;
  for (const auto& row : kPartRows) {
    const MeasureKey key{group, part, row.measure};
    text += line(evaluation, fmt::format("  {}", row.label), [&](const MethodResult& method) {
      return cell(method.estimates, method.runs, key, row.style, false);
    });
  }
  if (text.empty()) return "";
  return fmt::format("{}, {} {}\n", part, objects, objects == 1 ? "object" : "objects") + text;
}

Json json_of(const Estimate& estimate) {
  Json json = {{"median", rounded(estimate.median)}, {"spread", rounded(estimate.spread)}};
  if (estimate.low && estimate.high) {
    json["low"] = rounded(*estimate.low);
    json["high"] = rounded(*estimate.high);
  }
  return json;
}

bool is_told(const flies::MissedInRuns& missed) {
  return std::any_of(missed.stages.begin(), missed.stages.end(), [](int runs) { return runs > 0; });
}

Json json_of(const std::array<int, flies::kPersonStageCount>& people) {
  Json json = Json::object();
  for (std::size_t i = 0; i < people.size(); ++i) json[flies::kPersonStageNames[i]] = people[i];
  return json;
}

Json json_of(const flies::PeopleLosses& losses) {
  Json json = {{"people", json_of(losses.people)},
               {"boxes_per_pair", rounded(losses.boxes_per_pair)},
               {"recall", Json::array()}};
  for (const auto& [boxes, recall] : losses.recall)
    json["recall"].push_back({{"boxes", boxes ? Json(*boxes) : Json(nullptr)}, {"recall", rounded(recall)}});
  return json;
}

Json json_of(const flies::MissedInRuns& missed) {
  const auto& object = missed.object;
  Json json = {{"name", missed.frame_name},
               {"class", object.type},
               {"track", object.track},
               {"x_m", rounded(object.footprint.x_m)},
               {"y_m", rounded(object.footprint.y_m)},
               {"near_range_m", rounded(flies::near_range_m(object.footprint))},
               {"occlusion", object.occlusion},
               {"runs", missed.runs}};
  if (is_told(missed)) json["stages"] = json_of(missed.stages);
  return json;
}

/// A cell of the people's part; methods that do not look for them have none.
std::string people_cell(const MethodResult& method, const MeasureKey& key, const Style& style, bool with_interval) {
  return method.people ? cell(method.people->estimates, method.runs, key, style, with_interval) : "-";
}

/// Everything on people: all, then by range.
std::string people_lines(const Evaluation& evaluation, const flies::PeopleOptions& options) {
  std::string text = fmt::format("people: {} to be found to {:g} m, at least {:g} px high\n", evaluation.people,
                                 options.max_range_m, options.min_height_px);
  for (const auto& row : kPeopleRows)
    text += line(evaluation, fmt::format("  {}", row.label), [&](const MethodResult& method) {
      return people_cell(method, {Group::all, "", row.measure}, row.style, true);
    });
  text += line(evaluation, "  time to the verdicts [ms]", [](const MethodResult& method) {
    return method.people && method.people->time_ms ? fmt::format("{:.1f}", *method.people->time_ms) : "-";
  });
  for (const auto& [part, count] : evaluation.people_by_range) {
    text += fmt::format("  {}, {} {}\n", part, count, count == 1 ? "person" : "people");
    for (const auto& row : kPeopleRows)
      text += line(evaluation, fmt::format("    {}", row.label), [&, &part = part](const MethodResult& method) {
        return people_cell(method, {Group::by_range, part, row.measure}, row.style, false);
      });
  }
  return text;
}

/// Everything on scans; empty where nobody has one.
std::string scan_lines(const Evaluation& evaluation, const flies::SectorOptions& options) {
  std::string text;
  for (const auto& row : kScanRows)
    text += line(evaluation, "  " + fmt::format(fmt::runtime(row.label), options.near_range_m),
                 [&](const MethodResult& method) {
                   const MeasureKey key{Group::all, "", row.measure};
                   return method.scan ? cell(method.scan->estimates, method.runs, key, row.style, true) : "-";
                 });
  if (text.empty()) return "";
  return fmt::format(
             "scan: {} sectors of {:g} degrees with something {:g} to {:g} m away, {} nearer than {:g} m, {} open\n",
             evaluation.sectors.sectors, options.increment_deg, options.min_range_m, options.max_range_m,
             evaluation.sectors.near_sectors, options.near_range_m, evaluation.sectors.open_sectors) +
         text;
}

Json json_of(const flies::ScanResult& scan) {
  Json json = {{"all", Json::object()}, {"curve", Json::array()}};
  for (const auto& [key, estimate] : scan.estimates) json["all"][key.measure] = json_of(estimate);
  for (const auto& [setting, values] : scan.curve) {
    Json point = {{scan.setting, setting}};
    for (const auto& [key, value] : values) point[key.measure] = rounded(value);
    json["curve"].push_back(std::move(point));
  }
  return json;
}

bool looks_for_people(const Evaluation& evaluation) {
  return std::any_of(evaluation.methods.begin(), evaluation.methods.end(),
                     [](const MethodResult& method) { return method.people.has_value(); });
}

std::string missed_line(const flies::MissedInRuns& missed, int runs) {
  const auto& object = missed.object;
  return fmt::format("  {:<12} {:<16} x {:6.2f} y {:6.2f} m, near face {:5.2f} m, occlusion {}, in {} of {} runs\n",
                     missed.frame_name, fmt::format("{} {}", object.type, object.track), object.footprint.x_m,
                     object.footprint.y_m, flies::near_range_m(object.footprint), object.occlusion, missed.runs, runs);
}

/// "no box 2, first look 1": in how many runs each stage lost the person.
std::string stages_text(const std::array<int, flies::kPersonStageCount>& people) {
  std::string text;
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (people[i] == 0) continue;
    std::string name(flies::kPersonStageNames[i]);
    std::replace(name.begin(), name.end(), '_', ' ');
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, people[i]);
  }
  return text;
}

std::string missed_person_line(const flies::MissedInRuns& missed, int runs) {
  std::string text = missed_line(missed, runs);
  if (!is_told(missed)) return text;
  text.pop_back();
  return text + fmt::format(": {}\n", stages_text(missed.stages));
}

/// Where people got lost, and what the proposals are worth.
std::string losses_lines(const flies::PeopleLosses& losses, const std::string& method) {
  if (losses.recall.empty()) return "";
  std::string text =
      fmt::format("people by the stage that lost them, {}, all runs: {}\n", method, stages_text(losses.people));
  text += fmt::format("{:.0f} boxes a pair; people with a box of their own among", losses.boxes_per_pair);
  for (const auto& [boxes, recall] : losses.recall)
    text += boxes ? fmt::format(" the {} surest {:.3f},", *boxes, recall) : fmt::format(" all {:.3f}\n", recall);
  return text;
}

std::string false_alarm_line(const flies::FalseAlarm& alarm) {
  const auto& [name, p] = alarm;
  return fmt::format("  {:<12} probability {:.4f}, x {:6.2f} y {:6.2f} m, box u {:.0f} v {:.0f}, {:.0f} x {:.0f} px\n",
                     name, p.probability, p.x_m, p.y_m, p.box.u_px, p.box.v_px, p.box.width_px, p.box.height_px);
}

Json json_of(const flies::ErrorPoint& point) {
  return {{"false_alarms_per_frame", rounded(point.false_positives)}, {"miss_rate", rounded(point.miss_rate)}};
}

Json json_of(const flies::FalseAlarm& alarm) {
  const auto& [name, person] = alarm;
  return {{"name", name},
          {"x_m", rounded(person.x_m)},
          {"y_m", rounded(person.y_m)},
          {"probability", rounded(person.probability)},
          {"box",
           {{"u_px", rounded(person.box.u_px)},
            {"v_px", rounded(person.box.v_px)},
            {"width_px", rounded(person.box.width_px)},
            {"height_px", rounded(person.box.height_px)}}}};
}

Json json_of(const flies::PeopleResult& people, const Evaluation& evaluation) {
  Json json;
  json["time_ms"] = people.time_ms ? rounded(*people.time_ms) : Json(nullptr);
  json["all"] = json["by_range"] = Json::object();
  for (const auto& [part, count] : evaluation.people_by_range) json["by_range"][part]["people"] = count;
  for (const auto& [key, estimate] : people.estimates)
    (key.group == Group::all ? json["all"] : json["by_range"][key.part])[key.measure] = json_of(estimate);
  json["operating_point"] = json_of(people.operating_point);
  json["losses"] = people.losses ? json_of(*people.losses) : Json(nullptr);
  for (const auto* list : {"curve", "missed", "false_alarms"}) json[list] = Json::array();
  for (const auto& point : people.curve) json["curve"].push_back(json_of(point));
  for (const auto& missed : people.missed) json["missed"].push_back(json_of(missed));
  for (const auto& alarm : people.false_alarms) json["false_alarms"].push_back(json_of(alarm));
  return json;
}

Json json_of(const MethodResult& method, const Evaluation& evaluation) {
  Json json = {{"name", method.name}, {"runs", method.runs}};
  json["time_ms"] = method.time_ms ? rounded(*method.time_ms) : Json(nullptr);
  json["evaluations"] = method.evaluations ? rounded(*method.evaluations) : Json(nullptr);
  json["all"] = json["by_class"] = json["by_range"] = Json::object();
  for (const auto& [part, objects] : evaluation.by_class) json["by_class"][part]["objects"] = objects;
  for (const auto& [part, objects] : evaluation.by_range) json["by_range"][part]["objects"] = objects;
  for (const auto& [key, estimate] : method.estimates) {
    Json& group = json[key.group == Group::all ? "all" : key.group == Group::by_class ? "by_class" : "by_range"];
    (key.group == Group::all ? group : group[key.part])[key.measure] = json_of(estimate);
  }
  json["missed"] = Json::array();
  for (const auto& missed : method.missed) json["missed"].push_back(json_of(missed));
  json["people"] = method.people ? json_of(*method.people, evaluation) : Json(nullptr);
  json["scan"] = method.scan ? json_of(*method.scan) : Json(nullptr);
  return json;
}

/// How values lie: their number, median and the value that 90 % do not exceed.
struct Spread {
  std::size_t count = 0;
  std::optional<double> median, most;
};

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  constexpr double kMost = 0.9;
  std::sort(values.begin(), values.end());
  const double most = values[static_cast<std::size_t>(kMost * static_cast<double>(values.size() - 1))];
  const std::size_t count = values.size();
  return {count, flies::median(std::move(values)), most};
}

std::optional<double> mean_of(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Of squared normalised errors of two numbers, the share within what 95 % should keep to.
std::optional<double> share_within(const std::vector<double>& nees) {
  constexpr double kChiSquared95 = 5.991;
  const auto within = std::count_if(nees.begin(), nees.end(), [](double value) { return value <= kChiSquared95; });
  return flies::Rate{static_cast<int>(within), static_cast<int>(nees.size())}.value();
}

std::string sequence_line(const std::string& label, const std::string& text) {
  return fmt::format("  {:<{}} {}\n", label, kLabelWidth, text);
}

std::string text_of(const Spread& spread, const Style& style) {
  if (!spread.median) return "-";
  return fmt::format("{}, {}  ({})", number(*spread.median, style), number(*spread.most, style), spread.count);
}

std::string text_of(int hits, int total) {
  if (total == 0) return "-";
  return fmt::format("{:.3f}  ({} of {})", static_cast<double>(hits) / total, hits, total);
}

std::string nees_text(const std::vector<double>& nees) {
  if (nees.empty()) return "-";
  return fmt::format("{:.2f}, {:.3f}  ({})", *mean_of(nees), *share_within(nees), nees.size());
}

std::map<MeasureKey, double> scan_values_of(const std::vector<flies::ScanScore>& scores) {
  std::vector<std::size_t> all(scores.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return flies::scan_values(scores, all);
}

std::string scan_text(const std::vector<flies::ScanScore>& scores) {
  const auto values = scan_values_of(scores);
  std::string text;
  for (const char* measure : {"right", "blind", "ghost", "unknown"}) {
    const auto found = values.find({Group::all, "", measure});
    if (found == values.end()) return "-";
    text += fmt::format("{}{:.3f}", text.empty() ? "" : ", ", found->second);
  }
  return text;
}

Json json_or_null(const std::optional<double>& value) { return value ? rounded(*value) : Json(nullptr); }

Json json_of(const Spread& spread) {
  return {{"count", spread.count}, {"median", json_or_null(spread.median)}, {"most_90", json_or_null(spread.most)}};
}

Json nees_json(const std::vector<double>& nees) {
  return {
      {"count", nees.size()}, {"mean", json_or_null(mean_of(nees))}, {"within_95", json_or_null(share_within(nees))}};
}

Json scan_json(const std::vector<flies::ScanScore>& scores) {
  Json json = Json::object();
  for (const auto& [key, value] : scan_values_of(scores)) json[key.measure] = rounded(value);
  return json;
}

Json json_of(const flies::SequenceResult& sequence) {
  const auto& t = sequence.tracks;
  return {{"pairs", sequence.pairs},
          {"duration_s", rounded(sequence.duration_s)},
          {"objects", t.objects},
          {"found", t.found},
          {"recall", json_or_null(flies::Rate{t.found, t.objects}.value())},
          {"identity_switches", t.identity_switches},
          {"fragments", t.fragments},
          {"moving_velocity_error_mps", json_of(spread_of(t.moving_errors_mps))},
          {"standing_velocity_error_mps", json_of(spread_of(t.standing_errors_mps))},
          {"standing", t.standing},
          {"standing_reported_moving", t.false_motion},
          {"unlabelled", t.unlabelled},
          {"unlabelled_reported_moving", t.unlabelled_moving},
          {"first_report_s", json_of(spread_of(t.first_report_s))},
          {"never_reported", t.never_reported},
          {"first_velocity_s", json_of(spread_of(t.first_velocity_s))},
          {"never_with_velocity", t.never_with_velocity},
          {"position_nees", nees_json(t.position_nees)},
          {"velocity_nees", nees_json(t.velocity_nees)},
          {"ego",
           {{"pairs", sequence.ego.pairs},
            {"lost", sequence.ego.lost},
            {"speed_error", json_of(spread_of(sequence.ego.speed_errors))},
            {"yaw_rate_error_rps", json_of(spread_of(sequence.ego.yaw_rate_errors_rps))}}},
          {"scan", scan_json(sequence.scan)},
          {"single_pair_scan", scan_json(sequence.single_scan)},
          {"time_ms", json_of(spread_of(sequence.times_ms))}};
}

}  // namespace

std::string sequence_table(const flies::SequenceResult& sequence, const EvaluationContext& context) {
  const auto& t = sequence.tracks;
  std::string text = fmt::format(
      "sequence: {} pairs, {:.1f} s, followed from images alone, one run; objects from {:g} to {:g} m\n",
      sequence.pairs, sequence.duration_s, context.measuring.match.min_range_m, context.measuring.match.max_range_m);
  text += sequence_line("recall by tracks", text_of(t.found, t.objects));
  text += sequence_line("identity switches, fragments", fmt::format("{}, {}", t.identity_switches, t.fragments));
  text += "  medians, what 90 % do not exceed (how many)\n";
  text += sequence_line("velocity error, moving [m/s]", text_of(spread_of(t.moving_errors_mps), kMetres));
  text += sequence_line("velocity error, standing [m/s]", text_of(spread_of(t.standing_errors_mps), kMetres));
  const auto never = [](int count) { return count > 0 ? fmt::format(", never: {}", count) : std::string{}; };
  text += sequence_line("in view to first track [s]",
                        text_of(spread_of(t.first_report_s), kMetres) + never(t.never_reported));
  text += sequence_line("in view to right velocity [s]",
                        text_of(spread_of(t.first_velocity_s), kMetres) + never(t.never_with_velocity));
  text += sequence_line("ego speed error [%]", text_of(spread_of(sequence.ego.speed_errors), kPercent));
  constexpr Style kRates{1.0, 4, false};
  text += sequence_line("ego yaw rate error [rad/s]", text_of(spread_of(sequence.ego.yaw_rate_errors_rps), kRates));
  text += sequence_line("time to the tracks [ms]", text_of(spread_of(sequence.times_ms), kCount));
  text += "  shares\n";
  text += sequence_line("standing, said to move", text_of(t.false_motion, t.standing));
  text += sequence_line("on no label, said to move", text_of(t.unlabelled_moving, t.unlabelled));
  text += sequence_line("ego-motion lost", text_of(sequence.ego.lost, sequence.ego.pairs));
  text += "  errors squared over their covariance: mean (2 is right), share within 95 % (how many)\n";
  text += sequence_line("position", nees_text(t.position_nees));
  text += sequence_line("velocity", nees_text(t.velocity_nees));
  text += "  scan: right, blind, ghost, unknown\n";
  text += sequence_line("with memory", scan_text(sequence.scan));
  text += sequence_line("pair by pair", scan_text(sequence.single_scan));
  return text;
}

std::string evaluation_table(const Evaluation& evaluation, const EvaluationContext& context) {
  std::string text = fmt::format("{}: {}, {} pairs, {} with lidar, {} objects to be found from {:g} to {:g} m\n",
                                 context.folder, flies::kTruthKindNames[static_cast<std::size_t>(context.kind)],
                                 evaluation.frames, evaluation.frames_with_lidar, evaluation.objects,
                                 context.measuring.match.min_range_m, context.measuring.match.max_range_m);
  text += fmt::format("median of the runs ({:g} % interval over pairs) ~spread of the runs\n",
                      100.0 * context.measuring.estimate.confidence);
  text += line(evaluation, "", [](const MethodResult& method) {
    return fmt::format("{}, {} {}", method.name, method.runs, method.runs == 1 ? "run" : "runs");
  });
  for (const auto& row : kRows)
    text += line(evaluation, row.label, [&](const MethodResult& method) {
      return cell(method.estimates, method.runs, {Group::all, "", row.measure}, row.style, true);
    });
  text += line(evaluation, "fitness evaluations a pair", [](const MethodResult& method) {
    return method.evaluations ? fmt::format("{:.0f}", *method.evaluations) : "-";
  });
  text += line(evaluation, "time to the obstacles [ms]", [](const MethodResult& method) {
    return method.time_ms ? fmt::format("{:.1f}", *method.time_ms) : "-";
  });
  for (const auto& [part, count] : evaluation.by_class) text += part_lines(evaluation, Group::by_class, part, count);
  for (const auto& [part, count] : evaluation.by_range) text += part_lines(evaluation, Group::by_range, part, count);
  text += scan_lines(evaluation, context.measuring.sectors);
  if (looks_for_people(evaluation)) text += people_lines(evaluation, context.measuring.people);
  return text;
}

std::string missed_table(const Evaluation& evaluation) {
  std::string text;
  const auto heading = [](const std::string& what, const std::string& method, bool is_empty) {
    return fmt::format("{} {}{}\n", what, method, is_empty ? ": nothing" : ":");
  };
  for (const auto& method : evaluation.methods) {
    if (method.finds_obstacles) {
      text += heading("missed by", method.name, method.missed.empty());
      for (const auto& missed : method.missed) text += missed_line(missed, method.runs);
    }
    if (!method.people) continue;
    text += heading("people missed by", method.name, method.people->missed.empty());
    for (const auto& missed : method.people->missed) text += missed_person_line(missed, method.runs);
    if (method.people->losses) text += losses_lines(*method.people->losses, method.name);
    text += heading(method.runs > 1 ? "false alarms on people, first run of" : "false alarms on people of", method.name,
                    method.people->false_alarms.empty());
    for (const auto& alarm : method.people->false_alarms) text += false_alarm_line(alarm);
  }
  return text;
}

cv::Mat people_curves(const Evaluation& evaluation) {
  std::vector<flies::ErrorCurve> curves;
  for (const auto& method : evaluation.methods)
    if (method.people) curves.push_back({method.name, method.people->curve, method.people->operating_point});
  return flies::draw_error_curves(curves, {.false_positives_label = "false alarms a pair",
                                           .min_false_positives = 1e-2,
                                           .max_false_positives = 10.0,
                                           .min_miss_rate = 0.02});
}

cv::Mat scan_curves(const Evaluation& evaluation) {
  std::vector<flies::ErrorCurve> curves;
  for (const auto& method : evaluation.methods) {
    if (!method.scan) continue;
    const auto point_of = [](const auto& values, const auto& value_of) {
      const auto share = [&](const char* measure) {
        const auto found = values.find({flies::MeasureKey::Group::all, "", measure});
        return found == values.end() ? 0.0 : value_of(found->second);
      };
      return flies::ErrorPoint{share("ghost"), share("blind")};
    };
    flies::ErrorCurve curve{method.name, {}, {}};
    for (const auto& point : method.scan->curve)
      curve.points.push_back(point_of(point.values, [](double value) { return value; }));
    std::sort(curve.points.begin(), curve.points.end(),
              [](const auto& a, const auto& b) { return a.false_positives < b.false_positives; });
    curve.operating_point = point_of(method.scan->estimates, [](const flies::Estimate& e) { return e.median; });
    curves.push_back(std::move(curve));
  }
  return flies::draw_error_curves(curves, {.false_positives_label = "ghost sectors, share",
                                           .miss_rate_label = "blind sectors, share",
                                           .min_false_positives = 1e-2,
                                           .max_false_positives = 1.0,
                                           .min_miss_rate = 0.01});
}

std::string evaluation_json(const Evaluation& evaluation, const EvaluationContext& context,
                            const std::optional<flies::SequenceResult>& sequence) {
  Json json = {{"truth", context.folder},
               {"kind", flies::kTruthKindNames[static_cast<std::size_t>(context.kind)]},
               {"pairs", evaluation.frames},
               {"pairs_with_lidar", evaluation.frames_with_lidar},
               {"objects", evaluation.objects},
               {"seed", context.options.seed},
               {"preset", context.preset},
               {"people", evaluation.people},
               {"sectors", evaluation.sectors.sectors},
               {"near_sectors", evaluation.sectors.near_sectors},
               {"open_sectors", evaluation.sectors.open_sectors},
               {"match", json_of_options(context.measuring.match)},
               {"people_options", json_of_options(context.measuring.people)},
               {"estimate", json_of_options(context.measuring.estimate)},
               {"sector_options", json_of_options(context.measuring.sectors)},
               {"dense", json_of_options(context.dense)},
               {"hog", json_of_options(context.hog)},
               {"tracker", json_of_options(context.tracker)},
               {"options", json_of_options(context.options)},
               {"methods", Json::array()}};
  for (const auto& method : evaluation.methods) json["methods"].push_back(json_of(method, evaluation));
  json["sequence"] = sequence ? json_of(*sequence) : Json(nullptr);
  constexpr int kIndent = 2;
  return json.dump(kIndent, ' ', false, Json::error_handler_t::replace) + "\n";
}
