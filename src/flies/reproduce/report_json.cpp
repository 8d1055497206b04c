#include <cmath>
#include <nlohmann/json.hpp>

#include "flies/core/options.hpp"
#include "flies/io/json_values.hpp"
#include "flies/reproduce/report.hpp"

namespace flies {
namespace {

using Json = nlohmann::ordered_json;

Json value_json(const std::optional<double>& value) { return value ? rounded(*value) : Json(nullptr); }
Json spread_json(const std::optional<Spread>& s) {
  if (!s) return nullptr;
  return {{"median", rounded(s->median)}, {"min", rounded(s->min)}, {"max", rounded(s->max)}};
}

Json run_json(const PersonPlace& person, const PersonRun& run) {
  Json json = {{"seed", run.seed}};
  for (const auto& measure : experiment_rows())
    if (measure.value != nullptr) json[std::string(measure.key)] = value_json(measure.value(person, run));
  return json;
}

Json person_json(const ReportSet& set, const MeasuredPerson& measured) {
  const auto& person = measured.experiment.person;
  Json json = {{"frame", set.frames[measured.frame]},  {"person", person.name},
               {"x_m", rounded(person.near.x_m)},      {"y_m", rounded(person.near.y_m)},
               {"range_m", rounded(person.range_m())}, {"runs", Json::array()}};
  for (const auto& run : measured.experiment.runs) json["runs"].push_back(run_json(person, run));
  return json;
}

Json timing_json(const Timing& timing) {
  Json json = {
      {"frame", timing.frame}, {"runs", timing.runs}, {"threads", timing.threads}, {"evaluations", timing.evaluations}};
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    json["median_ms"][std::string(kStageNames[stage])] = rounded(timing.median_ms[stage]);
  return json;
}

Json set_json(const ReportSet& set) {
  Json json = {{"title", set.title}, {"frames", set.frames.size()}};
  for (std::size_t i = 0; i < experiment_rows().size(); ++i)
    json["table"][std::string(experiment_rows()[i].key)] = spread_json(set.result.rows[i]);
  json["timing"] = timing_json(set.result.timing);
  json["people"] = Json::array();
  for (const auto& person : set.result.people) json["people"].push_back(person_json(set, person));
  return json;
}

}  // namespace

std::string json_report(const std::vector<ReportSet>& sets, const PersonOptions& options,
                        const ReportContext& context) {
  Json json = {{"command", context.command},
               {"version", context.version},
               {"cpu", context.cpu},
               {"first_seed", options.first_seed},
               {"seeds", options.seeds}};
  for (const auto& listing : list_options(options.method)) json["options"][listing.path] = listing.value;
  for (const auto& measure : experiment_rows()) json["paper"][std::string(measure.key)] = value_json(measure.paper);
  json["sets"] = Json::array();
  for (const auto& set : sets) json["sets"].push_back(set_json(set));
  // Names of files may hold bytes that are not UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace flies
