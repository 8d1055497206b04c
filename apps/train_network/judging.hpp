#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "flies/classify/people_model.hpp"
#include "flies/core/options.hpp"
#include "flies/train/train.hpp"
#include "windows.hpp"

namespace flies {

/// What a network that has learnt is judged by, and what it is put behind.
struct JudgingOptions {
  int judged = 30'000;
  double background_share = 1e-3;
  double reject_below = -2.0;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("judged", self.judged, Range{100, 10000000},
          "number of windows without people kept apart, for calibration, threshold and report");
    field("background_share", self.background_share, Range{0.0, 0.5}, "the threshold lets this share of them through");
    field("reject_below", self.reject_below, Range{-100.0, 100.0},
          "windows with a lower score at the first look are rejected: that of the linear machine, or with --first-look "
          "that of the network in front of it");
  }
};

/// Windows that were kept apart.
struct JudgedPlaces {
  std::vector<Place> people;      ///< each as labelled and once moved
  std::vector<Place> background;  ///< without people
};

JudgedPlaces judged_places(std::span<const Picture> kept_apart, std::uint64_t seed, const JudgingOptions& options);

/// What the model says of each, as `flies` runs it. @param progress called after each window
std::vector<double> probabilities(const PeopleModel& model, std::span<const Picture> pictures,
                                  std::span<const Place> places, const std::function<void()>& progress = {});

/// Finds the model's calibration, the say of its linear machine, and its threshold, on the windows that were kept apart
/// and that its first look lets through.
/// @throws InputError when it lets too little through to tell
void calibrate(PeopleModel& model, std::span<const Picture> kept_apart, const JudgedPlaces& judged, double share);

/// One line: the share of people missed where so many windows without people pass, and the calibration error.
std::string missed_line(const std::string& name, std::span<const double> people, std::span<const double> background);

/// The model and what it makes of the windows kept apart, for the report.
TrainingResult validated(const PeopleModel& model, const JudgedPlaces& places, std::span<const double> people,
                         std::span<const double> background);

}  // namespace flies
