#pragma once

#include "flies/synth/geometry.hpp"
#include "flies/synth/person.hpp"

namespace flies::synth {

/// Somebody who rides a bicycle standing on the pedals, facing +x, wheels on z = 0, the middle above the origin. The
/// phase of the look is that of the pedals.
Mesh cyclist(const PersonLook& look);

}  // namespace flies::synth
