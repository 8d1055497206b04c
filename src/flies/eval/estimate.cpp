#include "flies/eval/estimate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

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
  add("height_error_m", accuracy.height_error_m);
  add("absolute_height_error_m", accuracy.absolute_height_error_m);
}

/// Every measure's values in the runs, over some of the frames.
std::map<MeasureKey, std::vector<double>> values_of_runs(std::span<const FrameTruth> truths,
                                                         std::span<const std::vector<FrameScore>> runs,
                                                         std::span<const std::size_t> frames) {
  std::map<MeasureKey, std::vector<double>> values;
  for (const auto& scores : runs)
    for (const auto& [key, value] : named_values(summarize(truths, scores, frames))) values[key].push_back(value);
  return values;
}

/// In how many of the frames, each by itself, a measure has a value.
std::map<MeasureKey, int> frames_with_value(std::span<const FrameTruth> truths,
                                            std::span<const std::vector<FrameScore>> runs) {
  std::map<MeasureKey, int> counts;
  for (std::size_t frame = 0; frame < truths.size(); ++frame)
    for (const auto& [key, values] : values_of_runs(truths, runs, std::span(&frame, 1))) ++counts[key];
  return counts;
}

double quantile(std::vector<double>& values, double q) {
  const auto at = values.begin() + std::lround(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
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
  values[{Group::all, "", "obstacles_per_frame"}] = measures.obstacles_per_frame;
  if (measures.reports_per_found_object > 0.0)
    values[{Group::all, "", "reports_per_found_object"}] = measures.reports_per_found_object;
  for (const auto& part : measures.by_class) add_accuracy(part.accuracy, Group::by_class, part.name, values);
  for (const auto& part : measures.by_range) add_accuracy(part.accuracy, Group::by_range, part.name, values);
  return values;
}

std::map<MeasureKey, Estimate> estimate_measures(std::span<const FrameTruth> truths,
                                                 std::span<const std::vector<FrameScore>> runs,
                                                 const EstimateOptions& options) {
  assert(!runs.empty());
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < truths.size(); ++i) frames.push_back(i);
  std::map<MeasureKey, Estimate> estimates;
  for (const auto& [key, values] : values_of_runs(truths, runs, frames)) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    estimates[key] = {*median(values), *most - *least, std::nullopt, std::nullopt};
  }
  if (truths.size() < 2 || options.resamples == 0) return estimates;

  std::map<MeasureKey, std::vector<double>> resampled;
  for (int i = 0; i < options.resamples; ++i) {
    const auto drawn = draw_frames(truths.size(), options.seed, static_cast<std::uint32_t>(i));
    for (auto& [key, values] : values_of_runs(truths, runs, drawn))
      resampled[key].push_back(*median(std::move(values)));
  }
  const auto informative = frames_with_value(truths, runs);
  for (auto& [key, values] : resampled) {
    const auto estimate = estimates.find(key);
    // Drawing from a single frame that has a say would feign certainty.
    if (estimate == estimates.end() || informative.at(key) < 2) continue;
    estimate->second.low = quantile(values, (1.0 - options.confidence) / 2.0);
    estimate->second.high = quantile(values, (1.0 + options.confidence) / 2.0);
  }
  return estimates;
}

}  // namespace flies
