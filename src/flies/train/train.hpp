#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "flies/classify/people_model.hpp"
#include "flies/eval/window_rates.hpp"
#include "flies/train/checkpoint.hpp"
#include "flies/train/train_options.hpp"
#include "flies/train/training_picture.hpp"

namespace flies {

/// What is learnt from.
struct TrainingData {
  std::vector<TrainingPicture> people;
  std::vector<TrainingPicture> background;
};

/// A validation window and what the model made of it.
struct JudgedWindow {
  TrainingWindow window;
  double probability = 0.0;
};

struct TrainingResult {
  PeopleModel model;
  std::size_t people = 0;  ///< windows with people that the machines learnt from, mirrored and jittered ones included
  std::size_t background = 0;  ///< windows without
  std::vector<RoundSummary> rounds;

  WindowScores validation;             ///< probabilities by the machines that had not seen these pictures
  double validation_rate = 0.0;        ///< share of the validation people above the model's threshold
  std::vector<JudgedWindow> missed;    ///< people with the lowest probability, lowest first
  std::vector<JudgedWindow> mistaken;  ///< background with the highest probability, highest first
};

/// Called with a chapter's name ("hard windows, round 1"), what of it is done, and the whole.
using TrainingProgress = std::function<void(std::string_view chapter, std::size_t done, std::size_t total)>;

/// Trains a people model: a linear machine on people and random background, then rounds of hard background windows, on
/// request a kernel machine behind it, calibration and threshold on pictures kept apart, and in the end the same
/// machines once more on all pictures. docs/training.md tells it at length.
/// @param data       both kinds of pictures, at least `kMinPictures` each
/// @param checkpoint goes on from its state; the result is the same as without an interruption
/// @throws InputError when there are too few pictures, from reading a picture, or when `checkpoint` cannot be written
TrainingResult train_people(const TrainingData& data, const TrainOptions& options, Checkpoint& checkpoint,
                            const TrainingProgress& progress = {});

/// Fewest pictures of each kind: some are kept apart.
inline constexpr std::size_t kMinPictures = 4;

}  // namespace flies
