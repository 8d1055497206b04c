#pragma once

#include <span>
#include <string>

#include "flies/train/train.hpp"
#include "flies/train/training_report.hpp"
#include "judging.hpp"
#include "learning.hpp"

namespace flies {

/// Validation of a network as `flies train` has it of its machines: on windows kept apart, at the same rates.
std::string network_summary(const TrainingResult& result, const JudgingOptions& options);

/// The page of a network's training: as that of `flies train`, with the epochs instead of the linear machine's weights.
/// @param epochs empty when the network was there already
std::string network_report_html(const TrainingResult& result, std::span<const Picture> kept_apart,
                                std::span<const EpochSummary> epochs, const LearningOptions& learning,
                                const JudgingOptions& judging, const TrainingContext& context);

}  // namespace flies
