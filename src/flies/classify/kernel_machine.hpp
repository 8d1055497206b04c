#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "flies/classify/kernels/panels.hpp"
#include "flies/classify/people_model.hpp"

namespace flies {

/// A kernel stage laid out to score several windows at once: its 3.6 MB are then read once for all of them.
class KernelMachine {
 public:
  explicit KernelMachine(const KernelStage& stage);

  /// The same as `kernel_score` but for rounding, and the same on every machine. Threads: oneTBB's current arena.
  /// @param features of one window after the other
  /// @returns one score per window
  std::vector<double> scores(std::span<const float> features) const;

 private:
  std::vector<float> mean_, squares_, coefficients_;
  kernels::Panels projection_, support_vectors_;
  double gamma_ = 1.0, bias_ = 0.0;
};

}  // namespace flies
