#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "evaluate/evaluation_report.hpp"
#include "evaluate/sequence_report.hpp"
#include "shared/report_json.hpp"

namespace {

using flies::Estimate;
using flies::Evaluation;
using flies::MethodResult;
using Group = flies::MeasureKey::Group;
using Json = nlohmann::ordered_json;

Json json_of(const Estimate& estimate) {
  Json json = {{"median", rounded(estimate.median)}, {"spread", rounded(estimate.spread)}};
  if (estimate.low && estimate.high) {
    json["low"] = rounded(*estimate.low);
    json["high"] = rounded(*estimate.high);
  }
  return json;
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
  const auto is_some = [](int runs) { return runs > 0; };
  if (std::ranges::any_of(missed.stages, is_some)) json["stages"] = json_of(missed.stages);
  return json;
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

Json json_of(const flies::ErrorPoint& point) {
  return {{"false_alarms_per_frame", rounded(point.false_positives)}, {"miss_rate", rounded(point.miss_rate)}};
}

Json json_of(const flies::FalseAlarm& alarm) {
  const auto& [name, person] = alarm;
  return {{"name", name},
          {"x_m", rounded(person.x_m)},
          {"y_m", rounded(person.y_m)},
          {"probability", rounded(person.probability)},
          {"box", flies::box_json(person.box)}};
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

}  // namespace

std::string evaluation_json(const Evaluation& evaluation, const EvaluationContext& context,
                            const std::optional<flies::SequenceResult>& sequence) {
  Json json = {{"truth", context.folder},
               {"kind", flies::kTruthKindNames[static_cast<std::size_t>(context.kind)]},
               {"notes", context.notes},
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
  json["sequence"] = sequence ? sequence_json(*sequence) : Json(nullptr);
  constexpr int kIndent = 2;
  return json.dump(kIndent, ' ', false, Json::error_handler_t::replace) + "\n";
}
