#include "evaluate/evaluation_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include "evaluate/report_style.hpp"

namespace {

using flies::Estimate;
using flies::Evaluation;
using flies::MeasureKey;
using flies::MethodResult;
using Group = MeasureKey::Group;

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

bool is_told(const flies::MissedInRuns& missed) {
  return std::any_of(missed.stages.begin(), missed.stages.end(), [](int runs) { return runs > 0; });
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

}  // namespace

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
