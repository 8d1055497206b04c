#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "flies/train/train.hpp"

namespace flies {

/// Judges `result.model` on pictures that it did not learn from: fits the calibration of its machines and its
/// threshold, and fills in the validation part of the result. One picture is in memory at a time, and of each window
/// its scores.
/// @param people, background indices of the pictures kept apart
/// @param round              the background windows are those of this round
void validate(const TrainingData& data, std::span<const std::uint32_t> people,
              std::span<const std::uint32_t> background, std::uint32_t round, const TrainOptions& options,
              TrainingResult& result, const std::function<void(std::size_t done, std::size_t total)>& progress);

/// Fills in what the report says of people found and of mistakes, from what the model made of windows kept apart and
/// from its threshold; `validation.negatives` is left to the caller.
void note_mistakes(std::span<const JudgedWindow> people, std::span<const JudgedWindow> background,
                   TrainingResult& result);

}  // namespace flies
