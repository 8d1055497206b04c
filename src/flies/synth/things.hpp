#pragma once

#include "flies/core/random.hpp"
#include "flies/synth/geometry.hpp"

namespace flies::synth {

// Things of rooms, stores and pavements, each around its own origin and on z = 0.

/// Wood of a random tone; boards of `board_m`.
Material wood(FlyRandom& random, float texture_contrast, float board_m = 0.12F);

/// Table with four legs, 0.9 to 1.7 m long, cups and books upon it.
Mesh table(FlyRandom& random, float texture_contrast);
/// Chair with four legs and a back, facing +x.
Mesh chair(FlyRandom& random, float texture_contrast);
/// Cupboard with doors towards +x, its back at x = 0, 0.8 to 2 m high.
Mesh cupboard(FlyRandom& random, float texture_contrast);
/// Cardboard box with a label and tape, as long, wide and high as told.
Mesh carton(FlyRandom& random, const Vec3& size_m, float texture_contrast);
/// Lamp on a thin stand, 1.4 to 1.8 m high.
Mesh floor_lamp(FlyRandom& random, float texture_contrast);
/// Picture in a frame on a wall y = 0 that is seen from +y, its middle at `centre`.
Mesh picture(FlyRandom& random, const Vec3& centre, float texture_contrast);
/// Euro pallet, 1.2 by 0.8 m, empty or laden with cartons.
Mesh pallet(FlyRandom& random, bool laden, float texture_contrast);
/// A bay of a rack, `length_m` along +x, its front at y = 0 seen from +y: uprights, four boards, cartons upon them.
Mesh rack(FlyRandom& random, float length_m, float texture_contrast);

}  // namespace flies::synth
