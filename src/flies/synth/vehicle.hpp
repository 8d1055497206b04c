#pragma once

#include "flies/core/random.hpp"
#include "flies/synth/geometry.hpp"

namespace flies::synth {

/// A passenger car of believable shape and random colour, size and body (saloon or hatchback), facing +x, wheels on
/// z = 0, its middle above the origin.
Mesh car(FlyRandom& random, float texture_contrast);

}  // namespace flies::synth
