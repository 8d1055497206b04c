#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "flies/classify/people_model.hpp"
#include "flies/train/train_options.hpp"
#include "flies/train/training_windows.hpp"

namespace flies {

/// What a machine learns from: features and kind of every window, people first.
struct Samples {
  Matrix features;
  std::vector<char> is_person;             ///< one per row
  std::vector<TrainingWindow> background;  ///< of the rows without a person, in their order
  std::size_t people = 0;                  ///< rows with a person
};

/// Pictures that are learnt from and pictures that are kept apart, by index.
struct HoldOut {
  std::vector<std::uint32_t> learnt, kept_apart;
};

/// Cuts the pictures, in their order, into runs and keeps `share` of the runs apart, evenly spread: pictures that
/// follow each other show the same street, and would make validation too rosy when they were torn apart.
/// @returns at least one picture on both sides when there are two or more
HoldOut split_in_runs(std::size_t pictures, double share);

/// All windows with people of these pictures.
Samples people_samples(std::span<const TrainingPicture> pictures, std::span<const std::uint32_t> chosen,
                       const HogGeometry& geometry, const TrainOptions& options);

/// Adds windows of background pictures, but for those that are there already.
void add_background(Samples& samples, std::span<const TrainingPicture> pictures,
                    std::span<const TrainingWindow> windows, const HogGeometry& geometry);

/// Drops background windows that fail the test.
void keep_background(Samples& samples, const std::function<bool(std::span<const float> features)>& is_kept);

}  // namespace flies
