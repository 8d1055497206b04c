#pragma once

#include <cstdint>
#include <span>

#include "flies/classify/people_model.hpp"
#include "flies/train/train_options.hpp"

namespace flies {

/// Trains a linear machine with LIBLINEAR (dual coordinate descent, hinge loss).
/// Takes 16 bytes for every feature of every window while it runs. One call at a time: LIBLINEAR draws from
/// `std::rand`.
/// @param features  a row a window
/// @param is_person one per window, both kinds must occur
/// @param seed      of the order in which LIBLINEAR visits the windows
/// @returns weights and bias, which the model file stores in 16 bits each; uncalibrated, rejecting nothing
LinearStage train_linear(const Matrix& features, std::span<const char> is_person, const LinearSvmOptions& options,
                         std::uint64_t seed);

/// Trains a machine with a Gaussian kernel on the features' principal axes with LIBSVM.
/// @param features  a row a window
/// @param is_person one per window, both kinds must occur
/// @param seed      of the search for the principal axes
/// @returns all numbers as the model file stores them; uncalibrated
KernelStage train_kernel(const Matrix& features, std::span<const char> is_person, const KernelSvmOptions& options,
                         std::uint64_t seed);

}  // namespace flies
