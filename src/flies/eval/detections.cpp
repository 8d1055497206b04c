#include "flies/eval/detections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "flies/core/convert.hpp"
#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/folder.hpp"

namespace flies {
namespace {

using nlohmann::json;

/// Metres, pixels, milliseconds and scores stay far below; larger numbers would overflow what is computed from them.
constexpr double kMaxReported = 1e15;

/// A place in the file, for errors.
struct Place {
  const std::string& source;
  int line;
  std::string field;  ///< "obstacles[2]"

  [[noreturn]] void fail(const std::string& key, const std::string& complaint) const {
    const std::string separator = field.empty() || key.empty() ? "" : ".";
    throw InputError(source, fmt::format("line {}", line), fmt::format("{}{}{}: {}", field, separator, key, complaint));
  }
};

std::optional<double> optional_number(const json& object, const char* key, const Place& place) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return std::nullopt;
  if (!found->is_number()) place.fail(key, fmt::format("found {}, expected a number", found->type_name()));
  const double value = found->get<double>();
  if (!(std::abs(value) <= kMaxReported)) place.fail(key, fmt::format("found {}, which nothing measures", value));
  return value;
}

double number(const json& object, const char* key, const Place& place) {
  const auto value = optional_number(object, key, place);
  if (!value) place.fail(key, "found none, expected a number");
  return *value;
}

/// As `optional_number`, of what cannot be below 0.
std::optional<double> optional_size(const json& object, const char* key, const Place& place) {
  const auto value = optional_number(object, key, place);
  if (value && *value < 0.0) place.fail(key, fmt::format("found {}, expected a number from 0", *value));
  return value;
}

/// As `number`, of the side of a box.
double side(const json& object, const char* key, const Place& place) {
  const double value = number(object, key, place);
  if (!(value > 0.0)) place.fail(key, fmt::format("found {}, expected a number above 0", value));
  return value;
}

Obstacle obstacle_of(const json& entry, const Place& place) {
  if (!entry.is_object()) place.fail("", fmt::format("found {}, expected an object", entry.type_name()));
  Obstacle obstacle;
  obstacle.x_m = number(entry, "x_m", place);
  obstacle.y_m = number(entry, "y_m", place);
  obstacle.range_m = optional_size(entry, "range_m", place).value_or(std::hypot(obstacle.x_m, obstacle.y_m));
  obstacle.width_m = optional_size(entry, "width_m", place).value_or(0.0);
  obstacle.depth_m = optional_size(entry, "depth_m", place).value_or(0.0);
  obstacle.height_m = optional_size(entry, "height_m", place).value_or(0.0);
  obstacle.score = optional_number(entry, "score", place).value_or(0.0);
  return obstacle;
}

ImageBox box_of(const json& entry, const Place& place) {
  const auto found = entry.find("box");
  if (found == entry.end() || !found->is_object()) place.fail("box", "found none, expected an object");
  const Place inside{place.source, place.line, place.field + ".box"};
  return {number(*found, "u_px", inside), number(*found, "v_px", inside), side(*found, "width_px", inside),
          side(*found, "height_px", inside)};
}

Pedestrian pedestrian_of(const json& entry, const Place& place) {
  const Obstacle as_obstacle = obstacle_of(entry, place);
  Pedestrian person;
  person.x_m = as_obstacle.x_m;
  person.y_m = as_obstacle.y_m;
  person.range_m = as_obstacle.range_m;
  person.height_m = as_obstacle.height_m;
  const auto probability = optional_number(entry, "probability", place);
  if (probability && (*probability < 0.0 || *probability > 1.0))
    place.fail("probability", fmt::format("found {}, expected 0 to 1 (other numbers belong into score)", *probability));
  person.probability = probability ? *probability : number(entry, "score", place);
  person.box = box_of(entry, place);
  return person;
}

/// A number or null a sector; `otherwise` for null, and for all when the list is left out.
std::vector<double> numbers_of(const json& scan, const char* key, std::size_t count, double otherwise,
                               const Place& place) {
  const auto found = scan.find(key);
  if (found == scan.end()) return std::vector<double>(count, otherwise);
  if (!found->is_array() || found->size() != count)
    place.fail(key, fmt::format("expected a list of {} numbers, one a sector", count));
  std::vector<double> numbers;
  for (const auto& entry : *found) {
    if (!entry.is_null() && !(entry.is_number() && std::isfinite(entry.get<double>()) && entry.get<double>() >= 0.0))
      place.fail(fmt::format("{}[{}]", key, numbers.size()),
                 fmt::format("found {}, expected a number from 0 or null",
                             entry.is_number() ? fmt::format("{}", entry.get<double>()) : entry.type_name()));
    numbers.push_back(entry.is_null() ? otherwise : entry.get<double>());
  }
  return numbers;
}

SectorState state_of(char letter, std::size_t sector, const Place& place) {
  for (std::size_t i = 0; i < kSectorStateNames.size(); ++i)
    if (kSectorStateNames[i].front() == letter) return static_cast<SectorState>(i);
  place.fail(fmt::format("states[{}]", sector), "found another letter, expected o, f or u");
}

Scan scan_of(const json& entry, const Place& place) {
  if (!entry.is_object()) place.fail("", fmt::format("found {}, expected an object", entry.type_name()));
  Scan scan;
  scan.angle_min_rad = number(entry, "angle_min_rad", place);
  scan.angle_increment_rad = number(entry, "angle_increment_rad", place);
  if (!(scan.angle_increment_rad > 0.0)) place.fail("angle_increment_rad", "expected a number above 0");
  const auto states = entry.find("states");
  if (states == entry.end() || !states->is_string()) place.fail("states", "found none, expected a text");
  for (const char letter : states->get_ref<const std::string&>())
    scan.states.push_back(state_of(letter, scan.size(), place));
  constexpr double kRounding = 1e-3;  // of a turn: increments are written with few digits
  if (const double turns = static_cast<double>(scan.size()) * scan.angle_increment_rad / (2.0 * std::numbers::pi);
      turns > 1.0 + kRounding)
    place.fail("states", fmt::format("found {} sectors of {} rad, which are {:.2f} turns, expected one at most",
                                     scan.size(), scan.angle_increment_rad, turns));
  if (!entry.contains("ranges_m")) place.fail("ranges_m", "found none, expected a list");
  scan.ranges_m = numbers_of(entry, "ranges_m", scan.size(), std::numeric_limits<double>::quiet_NaN(), place);
  scan.free_m = numbers_of(entry, "free_m", scan.size(), 0.0, place);
  scan.confidence = numbers_of(entry, "confidence", scan.size(), 1.0, place);
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (scan.states[i] == SectorState::obstacle && std::isnan(scan.ranges_m[i]))
      place.fail(fmt::format("ranges_m[{}]", i), "found null, expected the range of the obstacle");
  return scan;
}

/// Sum of the times of the stages before and with the last one; nothing where none is told.
std::optional<double> time_ms(const json& record, Stage last, const Place& place) {
  const auto stages = record.find("stage_ms");
  if (stages == record.end() || !stages->is_object()) return std::nullopt;
  std::optional<double> sum;
  for (std::size_t stage = 0; stage <= static_cast<std::size_t>(last); ++stage) {
    const std::string name(kStageNames[stage]);
    if (const auto time = optional_number(*stages, name.c_str(), place)) sum = sum.value_or(0.0) + *time;
  }
  return sum;
}

/// What a line says of a pair that could not be used is no finding.
void forget_findings(ReportedFrame& frame) {
  frame.obstacles.clear();
  if (frame.pedestrians) frame.pedestrians->clear();
  if (frame.scan) std::ranges::fill(frame.scan->states, SectorState::unknown);
}

ReportedFrame frame_of(const json& record, const std::string& source, int line) {
  const Place place{source, line, ""};
  if (record.is_discarded()) throw InputError(source, fmt::format("line {}", line), "not JSON");
  if (!record.is_object()) throw InputError(source, fmt::format("line {}", line), "found no object, expected one");
  ReportedFrame frame;
  frame.line = line;
  if (const auto found = record.find("frame"); found != record.end()) {
    const auto whole = found->is_number() ? whole_number<int>(found->get<double>()) : std::nullopt;
    if (!whole || *whole < 0)  // not printed: what is nested without end cannot be
      place.fail("frame", found->is_number()
                              ? fmt::format("found {}, expected a whole number from 0", found->get<double>())
                              : fmt::format("found {}, expected a whole number from 0", found->type_name()));
    frame.frame = *whole;
  }
  if (const auto found = record.find("left"); found != record.end()) {
    if (!found->is_string()) place.fail("left", fmt::format("found {}, expected a file name", found->type_name()));
    frame.left = found->get<std::string>();
  }
  if (const auto error = record.find("error"); error != record.end() && error->is_string())
    frame.is_unusable = !error->get_ref<const std::string&>().empty();
  const auto obstacles = record.find("obstacles");
  if (obstacles == record.end() || !obstacles->is_array()) place.fail("obstacles", "found none, expected a list");
  for (const auto& entry : *obstacles)
    frame.obstacles.push_back(obstacle_of(entry, {source, line, fmt::format("obstacles[{}]", frame.obstacles.size())}));
  if (const auto people = record.find("pedestrians"); people != record.end()) {
    if (!people->is_array()) place.fail("pedestrians", fmt::format("found {}, expected a list", people->type_name()));
    frame.pedestrians.emplace();
    for (const auto& entry : *people)
      frame.pedestrians->push_back(
          pedestrian_of(entry, {source, line, fmt::format("pedestrians[{}]", frame.pedestrians->size())}));
  }
  if (const auto scan = record.find("scan"); scan != record.end() && !scan->is_null())
    frame.scan = scan_of(*scan, {source, line, "scan"});
  if (frame.is_unusable) forget_findings(frame);
  frame.time_ms = time_ms(record, Stage::concentrate, place);
  frame.people_time_ms = time_ms(record, Stage::classify, place);
  return frame;
}

/// What some lines have and others not would be dropped with all that it says. Lines of pairs that could not be used
/// say that nothing was found.
template <class Part>
void check_part(std::vector<ReportedFrame>& frames, std::optional<Part> ReportedFrame::*part, const char* name,
                const std::string& source) {
  const auto first =
      std::ranges::find_if(frames, [&](const ReportedFrame& frame) { return (frame.*part).has_value(); });
  if (first == frames.end()) return;
  const Part example = *((*first).*part);
  for (auto& frame : frames) {
    if (frame.*part) continue;
    if (!frame.is_unusable)
      throw InputError(
          source, fmt::format("line {}", frame.line),
          fmt::format("{}: found none, but line {} has one: expected one in every line", name, first->line));
    frame.*part = example;
    forget_findings(frame);
  }
}

/// Of bytes: it takes some hundred times its length to parse. A pair has some 30 kB.
constexpr std::size_t kLongestLine = 16U << 20;

/// What tells the pair of line i apart: the name of its left image, or its number.
std::vector<std::string> keys_of(const std::vector<ReportedFrame>& reported, bool by_name, bool by_frame) {
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < reported.size(); ++i)
    keys.push_back(by_name ? detail::stem_of(reported[i].left)
                           : std::to_string(by_frame ? *reported[i].frame : static_cast<int>(i)));
  return keys;
}

}  // namespace

std::vector<ReportedFrame> parse_detections(std::string_view text, const std::string& source) {
  std::vector<ReportedFrame> frames;
  for (const auto& line : detail::lines_of(text)) {
    if (line.content.size() > kLongestLine)
      throw InputError(source, fmt::format("line {}", line.number),
                       fmt::format("has more than {} MB, expected the result of one pair", kLongestLine >> 20U));
    frames.push_back(frame_of(json::parse(line.content, nullptr, false), source, line.number));
  }
  check_part(frames, &ReportedFrame::pedestrians, "pedestrians", source);
  check_part(frames, &ReportedFrame::scan, "scan", source);
  return frames;
}

std::vector<ReportedFrame> read_detections(const std::string& path) {
  return parse_detections(detail::read_truth(path), path);
}

std::optional<std::string> note_on_unusable(const std::vector<ReportedFrame>& reported, const std::string& source) {
  const auto unusable = std::ranges::count_if(reported, &ReportedFrame::is_unusable);
  if (unusable == 0) return std::nullopt;
  return fmt::format("{}: {} of {} lines {} that the pair could not be used; {} as nothing found", source, unusable,
                     reported.size(), unusable == 1 ? "says" : "say", unusable == 1 ? "it counts" : "they count");
}

std::vector<std::string> notes_on_positions(const std::vector<ReportedFrame>& reported, const std::string& source) {
  constexpr double kNothingIsSoFar_m = 500.0;
  constexpr double kOtherOrigin_m = 3.0, kOtherMeasure = 0.1;  // from a bumper, or in space instead of on the ground
  std::vector<double> distances_m;
  std::size_t odd = 0;
  int first_odd = 0;
  const auto look_at = [&](const auto& things, int line) {
    for (const auto& thing : things) {
      const double distance_m = std::hypot(thing.x_m, thing.y_m);
      distances_m.push_back(distance_m);
      if (std::abs(thing.range_m - distance_m) <= kOtherOrigin_m + kOtherMeasure * distance_m) continue;
      if (odd++ == 0) first_odd = line;
    }
  };
  for (const auto& frame : reported) {
    look_at(frame.obstacles, frame.line);
    if (frame.pedestrians) look_at(*frame.pedestrians, frame.line);
  }
  std::vector<std::string> notes;
  if (const auto median_m = median(distances_m); median_m && *median_m > kNothingIsSoFar_m)
    notes.push_back(
        fmt::format("{}: half of the positions are over {:.0f} m away; x_m and y_m are to be metres, are these "
                    "millimetres or centimetres?",
                    source, *median_m));
  if (odd > 0)
    notes.push_back(
        fmt::format("{}: line {}: range_m is not the distance of x_m and y_m, as in {} of {} positions; if it means "
                    "something else, leave it out, for ranges are measured by it",
                    source, first_odd, odd, distances_m.size()));
  return notes;
}

std::vector<ReportedFrame> match_detections(std::vector<ReportedFrame> reported, const std::vector<PairPaths>& pairs,
                                            const std::string& source) {
  if (reported.size() != pairs.size())
    throw InputError(source, "",
                     fmt::format("found {} lines, expected {}, one per pair", reported.size(), pairs.size()));
  const bool by_name = std::all_of(reported.begin(), reported.end(), [](const auto& r) { return !r.left.empty(); });
  const bool by_frame =
      std::all_of(reported.begin(), reported.end(), [](const auto& r) { return r.frame.has_value(); });
  const auto keys = keys_of(reported, by_name, by_frame);
  std::map<std::string, std::size_t> line_of_key;
  for (std::size_t i = 0; i < reported.size(); ++i)
    if (!line_of_key.emplace(keys[i], i).second)
      throw InputError(source, fmt::format("line {}", reported[i].line),
                       fmt::format("found a second line for pair {}, expected one per pair", keys[i]));
  std::vector<ReportedFrame> ordered;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string key = by_name ? detail::stem_of(pairs[i].left) : std::to_string(i);
    const auto found = line_of_key.find(key);
    if (found == line_of_key.end())
      throw InputError(source, by_name ? "left" : "frame", fmt::format("found no line for pair {}", key));
    ordered.push_back(std::move(reported[found->second]));
  }
  return ordered;
}

}  // namespace flies
