#pragma once

#include "flies/core/random.hpp"

namespace flies::synth {

/// Any number from `low` to `high` is as likely as any other.
inline float between(FlyRandom& random, double low, double high) {
  return static_cast<float>(random.uniform(low, high));
}

}  // namespace flies::synth
