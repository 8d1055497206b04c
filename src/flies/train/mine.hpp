#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "flies/train/training_windows.hpp"

namespace flies {

/// A score for the features of one window; larger is more like a person. Called from several threads.
using WindowScorer = std::function<double(std::span<const float>)>;

/// Looks at new windows of every picture and returns those that the scorer takes for people or nearly does: above
/// `options.negatives.hard_above`, of every picture the hardest `per_picture`, of all the hardest `per_round`. One
/// picture a thread is in memory. Runs on oneTBB's current arena; the result does not depend on the number of threads.
/// @param chosen   indices of the pictures to look at
/// @param round    another round looks at other windows
/// @param progress called with the number of pictures done, from any thread but one at a time
/// @returns in falling order of their scores
/// @throws InputError from reading a picture
std::vector<TrainingWindow> mine_hard_windows(std::span<const TrainingPicture> pictures,
                                              std::span<const std::uint32_t> chosen, const HogGeometry& geometry,
                                              const WindowScorer& scorer, std::uint32_t round,
                                              const TrainOptions& options,
                                              const std::function<void(std::size_t)>& progress = {});

}  // namespace flies
