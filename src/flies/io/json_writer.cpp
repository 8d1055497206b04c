#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "flies/core/free_space.hpp"
#include "flies/core/people_obstacles.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/io/json_values.hpp"
#include "flies/io/writers.hpp"

namespace flies {
namespace {

using Json = nlohmann::ordered_json;

Json metres(double value_m) { return rounded(value_m, 3); }
Json radians_of(double angle_rad) { return rounded(angle_rad, 6); }
Json milliseconds(double value_ms) { return rounded(value_ms, 3); }

/// Six significant digits: scores of different fitness functions differ by many orders of magnitude.
Json score_of(double score) {
  if (!std::isfinite(score)) return nullptr;
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", score);
  return std::strtod(text, nullptr) + 0.0;
}

Json object_of(const Obstacle& obstacle) {
  return {{"x_m", metres(obstacle.x_m)},         {"y_m", metres(obstacle.y_m)},
          {"range_m", metres(obstacle.range_m)}, {"range_sd_m", metres(obstacle.range_sd_m)},
          {"width_m", metres(obstacle.width_m)}, {"middle_offset_m", metres(obstacle.middle_offset_m)},
          {"depth_m", metres(obstacle.depth_m)}, {"height_m", metres(obstacle.height_m)},
          {"score", score_of(obstacle.score)},   {"box", box_json(obstacle.box)}};
}

Json object_of(const Pedestrian& pedestrian) {
  return {{"x_m", metres(pedestrian.x_m)},           {"y_m", metres(pedestrian.y_m)},
          {"range_m", metres(pedestrian.range_m)},   {"range_sd_m", metres(pedestrian.range_sd_m)},
          {"height_m", metres(pedestrian.height_m)}, {"probability", score_of(pedestrian.probability)},
          {"box", box_json(pedestrian.box)}};
}

template <class Item>
Json array_of(const std::vector<Item>& items) {
  Json array = Json::array();
  for (const auto& item : items) array.push_back(object_of(item));
  return array;
}

/// People, each with the index of the obstacle that he is, or null.
Json people_of(const FrameRecord& record) {
  Json array = array_of(record.pedestrians);
  const auto own = obstacles_of_people(record.obstacles, record.pedestrians);
  for (std::size_t i = 0; i < own.size(); ++i) array[i]["obstacle"] = own[i] ? Json(*own[i]) : Json();
  return array;
}

Json object_of(const RoadPlane& road) {
  return {{"height_m", metres(road.height_m)}, {"slope", radians_of(road.slope)}, {"bank", radians_of(road.bank)}};
}

Json object_of(const StereoCamera& camera) {
  return {{"fx_px", rounded(camera.fx_px, 6)}, {"fy_px", rounded(camera.fy_px, 6)},
          {"cx_px", rounded(camera.cx_px, 6)}, {"cx_right_px", rounded(camera.cx_right_px, 6)},
          {"cy_px", rounded(camera.cy_px, 6)}, {"baseline_m", rounded(camera.baseline_m, 6)},
          {"width_px", camera.width_px},       {"height_px", camera.height_px}};
}

/// Not rounded, as `row_correction` is not: the run is to be made again with it.
Json object_of(const CameraMount& mount) {
  return {{"height_m", mount.height_m}, {"pitch_rad", mount.pitch_rad}, {"roll_rad", mount.roll_rad}};
}

/// Numbers and truth values as such, all else as texts.
Json object_of(const std::vector<std::pair<std::string, std::string>>& options) {
  Json object = Json::object();
  for (const auto& [name, text] : options) {
    Json value = Json::parse(text, nullptr, false);
    object[name] = value.is_primitive() && !value.is_discarded() ? std::move(value) : Json(text);
  }
  return object;
}

Json object_of(const RunRecord& run) {
  Json object = {{"version", run.version},
                 {"calibration", run.calibration},
                 {"camera", object_of(run.camera)},
                 {"mount", object_of(run.camera.mount)}};
  if (run.row_correction)
    object["row_correction"] = {{"offset_px", run.row_correction->offset_px},
                                {"roll_rad", run.row_correction->roll_rad},
                                {"middle_u_px", run.row_correction->middle_u_px}};
  if (!run.input.empty()) object["input"] = object_of(run.input);
  object["people_model"] = run.people_model;
  object["preset"] = run.preset;
  object["options"] = object_of(run.options);
  return object;
}

Json numbers_of(const std::vector<double>& values, Json (*written)(double)) {
  Json array = Json::array();
  for (const double value : values) array.push_back(written(value));
  return array;
}

/// @param camera that says how sure ranges are; null: not known, so left out
Json object_of(const Scan& scan, const StereoCamera* camera) {
  std::string letters;  // a list of words would be the longest part of the line
  for (const SectorState state : scan.states) letters += kSectorStateNames[static_cast<std::size_t>(state)].front();
  Json object = {{"angle_min_rad", radians_of(scan.angle_min_rad)},
                 {"angle_increment_rad", radians_of(scan.angle_increment_rad)},
                 {"ranges_m", numbers_of(scan.ranges_m, metres)}};
  if (camera != nullptr) {
    Json deviations = Json::array();
    for (const double range_m : scan.ranges_m) deviations.push_back(metres(range_deviation_m(*camera, range_m)));
    object["range_sd_m"] = std::move(deviations);
  }
  object["free_m"] = numbers_of(scan.free_m, metres);
  object["confidence"] = numbers_of(scan.confidence, score_of);
  object["states"] = letters;
  return object;
}

Json polygon_of(const std::vector<GroundPoint>& vertices) {
  Json array = Json::array();
  for (const auto& vertex : vertices) array.push_back(Json::array({metres(vertex.x_m), metres(vertex.y_m)}));
  return array;
}

Json object_of(const DiagnosisRecord& diagnosis) {
  const auto number = [](const std::optional<double>& value, int decimals) {
    return value ? rounded(*value, decimals) : Json();
  };
  return {{"textured_share", rounded(diagnosis.textured_share, 3)},
          {"matched_share", rounded(diagnosis.matched_share, 3)},
          {"beyond_share", rounded(diagnosis.beyond_share, 3)},
          {"row_offset_px", number(diagnosis.row_offset_px, 2)},
          {"row_roll_rad", number(diagnosis.row_roll_rad, 6)},
          {"corrected_row_offset_px", number(diagnosis.corrected_offset_px, 2)},
          {"road_found", diagnosis.road_found},
          {"mount",
           {{"height_m", metres(diagnosis.mount.height_m)},
            {"pitch_rad", radians_of(diagnosis.mount.pitch_rad)},
            {"roll_rad", radians_of(diagnosis.mount.roll_rad)},
            {"source", diagnosis.mount_is_from_road ? "road" : "given"}}},
          {"notes", diagnosis.notes}};
}

}  // namespace

std::string json_line(const FrameRecord& record) {
  Json stage_ms = Json::object();
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    stage_ms[std::string(kStageNames[stage])] = milliseconds(record.stage_ms[stage]);
  Json object = {{"frame", record.frame},           {"left", record.left},
                 {"right", record.right},           {"seed", record.seed},
                 {"preset", record.preset},         {"obstacles", array_of(record.obstacles)},
                 {"pedestrians", people_of(record)}};
  if (record.road) {
    object["road"] = object_of(*record.road);
    object["road"]["found"] = record.road_found;
  }
  if (!record.scan.empty()) {
    object["scan"] = object_of(record.scan, record.run ? &record.run->camera : nullptr);
    object["free_space"] = polygon_of(free_space(record.scan));
  }
  if (record.diagnosis) object["diagnosis"] = object_of(*record.diagnosis);
  if (record.run) object["run"] = object_of(*record.run);
  if (record.error.empty())
    object["stage_ms"] = stage_ms;
  else
    object["error"] = record.error;
  constexpr int kOneLine = -1;
  return object.dump(kOneLine, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace flies
