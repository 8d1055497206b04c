#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/eval/measures.hpp"

namespace flies {

/// How sure the measures are told to be.
struct EstimateOptions {
  int resamples = 1000;
  double confidence = 0.95;
  std::uint64_t seed = 1;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("resamples", self.resamples, Range{0, 1000000},
          "bootstrap samples of the frames for the confidence intervals; 0: no intervals");
    field("confidence", self.confidence, Range{0.01, 0.999}, "share of these samples that an interval covers");
    field("seed", self.seed, "seed of these samples");
  }
};

/// A measure over several runs of one method, which differ in their seeds.
struct Estimate {
  double median = 0.0;              ///< over the runs
  double spread = 0.0;              ///< largest minus smallest of the runs
  std::optional<double> low, high;  ///< interval over frames; none when fewer than two have a say
};

/// Which measure: of all, or of one class or band of range.
struct MeasureKey {
  enum class Group { all, by_class, by_range };
  Group group = Group::all;
  std::string part;     ///< "Cyclist", "10-20 m"; empty for all
  std::string measure;  ///< "recall", "absolute_range_error", ...; the names of the members of `Accuracy`

  auto operator<=>(const MeasureKey&) const = default;
};

/// Every measure that has a value, by its name.
std::map<MeasureKey, double> named_values(const Measures& measures);

/// Measures of one run over some of the frames; one that is named twice counts twice.
using ValuesOfRun = std::function<std::map<MeasureKey, double>(std::size_t run, std::span<const std::size_t> frames)>;

/// Median and spread of every measure over the runs, and its interval by the bootstrap over frames (Efron 1979,
/// percentile method): frames are drawn with replacement, the same for every run, and the median over the runs is
/// measured anew. Frames of a sequence resemble their neighbours, so its intervals come out too narrow.
/// @param runs at least 1
/// @returns measures that have a value in at least one run
std::map<MeasureKey, Estimate> estimate_values(std::size_t frames, std::size_t runs, const ValuesOfRun& values,
                                               const EstimateOptions& options = {});

/// The same for the measures of obstacles.
/// @param runs per run the scores of every frame, in the order of `truths`; at least one run
std::map<MeasureKey, Estimate> estimate_measures(std::span<const FrameTruth> truths,
                                                 std::span<const std::vector<FrameScore>> runs,
                                                 const EstimateOptions& options = {});

}  // namespace flies
