#include "flies/eval/estimate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "flies/core/quantile.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

using Group = MeasureKey::Group;
using Values = std::map<MeasureKey, double>;

void add_accuracy(const Accuracy& accuracy, Group group, const std::string& part, Values& values) {
  const auto add = [&](const char* name, const std::optional<double>& value) {
    if (value) values.emplace(MeasureKey{group, part, name}, *value);
  };
  add("recall", accuracy.recall.value());
  add("precision", accuracy.precision.value());
  add("label_precision", accuracy.label_precision.value());
  add("range_error", accuracy.range_error);
  add("absolute_range_error", accuracy.absolute_range_error);
  add("width_error_m", accuracy.width_error_m);
  add("absolute_width_error_m", accuracy.absolute_width_error_m);
  add("depth_error_m", accuracy.depth_error_m);
  add("absolute_depth_error_m", accuracy.absolute_depth_error_m);
  add("height_error_m", accuracy.height_error_m);
  add("absolute_height_error_m", accuracy.absolute_height_error_m);
}

/// Every measure's values in the runs, over some of the frames.
std::map<MeasureKey, std::vector<double>> values_of_runs(std::size_t runs, const ValuesOfRun& values_of,
                                                         std::span<const std::size_t> frames) {
  std::map<MeasureKey, std::vector<double>> values;
  for (std::size_t run = 0; run < runs; ++run)
    for (const auto& [key, value] : values_of(run, frames)) values[key].push_back(value);
  return values;
}

/// In how many of the frames, each by itself, a measure has a value.
std::map<MeasureKey, int> frames_with_value(std::size_t frames, std::size_t runs, const ValuesOfRun& values_of) {
  std::map<MeasureKey, int> counts;
  for (std::size_t frame = 0; frame < frames; ++frame)
    for (const auto& [key, values] : values_of_runs(runs, values_of, std::span(&frame, 1))) ++counts[key];
  return counts;
}

std::vector<std::size_t> draw_frames(std::size_t count, std::uint64_t seed, std::uint32_t resample) {
  std::vector<std::size_t> frames(count);
  FlyRandom random(seed, 0, resample, 0);
  for (auto& frame : frames) frame = random.below(static_cast<std::uint32_t>(count));
  return frames;
}

}  // namespace

std::map<MeasureKey, double> named_values(const Measures& measures) {
  Values values;
  add_accuracy(measures.all, Group::all, "", values);
  if (const auto people = measures.people_recall.value()) values[{Group::all, "", "people_recall"}] = *people;
  if (measures.whole_width_error_m) values[{Group::all, "", "whole_width_error_m"}] = *measures.whole_width_error_m;
  if (measures.whole_depth_error_m) values[{Group::all, "", "whole_depth_error_m"}] = *measures.whole_depth_error_m;
  values[{Group::all, "", "obstacles_per_frame"}] = measures.obstacles_per_frame;
  if (measures.reports_per_found_object > 0.0)
    values[{Group::all, "", "reports_per_found_object"}] = measures.reports_per_found_object;
  for (const auto& part : measures.by_class) add_accuracy(part.accuracy, Group::by_class, part.name, values);
  for (const auto& part : measures.by_range) add_accuracy(part.accuracy, Group::by_range, part.name, values);
  return values;
}

std::map<MeasureKey, Estimate> estimate_values(std::size_t frame_count, std::size_t runs, const ValuesOfRun& values_of,
                                               const EstimateOptions& options) {
  assert(runs >= 1);
  std::vector<std::size_t> frames(frame_count);
  std::iota(frames.begin(), frames.end(), std::size_t{0});
  std::map<MeasureKey, Estimate> estimates;
  for (const auto& [key, values] : values_of_runs(runs, values_of, frames)) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    estimates[key] = {*median(values), *most - *least, std::nullopt, std::nullopt};
  }
  if (frame_count < 2 || options.resamples == 0) return estimates;

  std::map<MeasureKey, std::vector<double>> resampled;
  for (int i = 0; i < options.resamples; ++i) {
    const auto drawn = draw_frames(frame_count, options.seed, static_cast<std::uint32_t>(i));
    for (auto& [key, values] : values_of_runs(runs, values_of, drawn))
      resampled[key].push_back(*median(std::move(values)));
  }
  const auto informative = frames_with_value(frame_count, runs, values_of);
  for (auto& [key, values] : resampled) {
    const auto estimate = estimates.find(key);
    // Drawing from a single frame that has a say would feign certainty.
    const auto frames_of_key = informative.find(key);
    if (estimate == estimates.end() || frames_of_key == informative.end() || frames_of_key->second < 2) continue;
    estimate->second.low = quantile(values, (1.0 - options.confidence) / 2.0);
    estimate->second.high = quantile(values, (1.0 + options.confidence) / 2.0);
  }
  return estimates;
}

std::map<MeasureKey, Estimate> estimate_measures(std::span<const FrameTruth> truths,
                                                 std::span<const std::vector<FrameScore>> runs,
                                                 const EstimateOptions& options) {
  const auto values = [&](std::size_t run, std::span<const std::size_t> frames) {
    return named_values(summarize(truths, runs[run], frames));
  };
  return estimate_values(truths.size(), runs.size(), values, options);
}

}  // namespace flies
