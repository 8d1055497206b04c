#pragma once

#include "flies/core/random.hpp"
#include "flies/synth/geometry.hpp"

namespace flies::synth {

/// Front of a house with windows, doors, sills and a cornice. It runs along +x from 0 to `length_m`, its face at
/// y = 0 looking towards +y; what stands out of the wall reaches up to 0.2 m before it.
Mesh house_front(FlyRandom& random, float length_m, float height_m, float texture_contrast);

/// Bare wall from x = 0 to `length_m`, face at y = 0 towards +y, `thickness_m` thick.
Mesh wall(FlyRandom& random, float length_m, float height_m, float thickness_m, float texture_contrast);

/// Street lamp 6 to 8 m tall whose arm reaches towards +y.
Mesh lamp_post(FlyRandom& random);
/// Pole with a round or triangular traffic sign facing -x.
Mesh sign_post(FlyRandom& random);
/// Knee-high to waist-high bollard.
Mesh bollard(FlyRandom& random);

/// From where to where a size is drawn, metres.
struct Sizes {
  double low, high;
  float draw(FlyRandom& random) const { return static_cast<float>(random.uniform(low, high)); }
};
/// Of a tree; as it stands, one of a street.
struct TreeSizes {
  Sizes height_m{5.0, 9.0};
  Sizes fork_m{2.0, 2.8};     ///< where the crown begins
  Sizes radius_m{0.11, 0.2};  ///< of the trunk
  Sizes crown_m{1.2, 2.0};    ///< half width of the crown
  int tufts = 22;             ///< of leaves
};
/// Tree of trunk, boughs and a crown of leaf tufts.
Mesh tree(FlyRandom& random, float texture_contrast, const TreeSizes& sizes = {});

/// Clipped hedge along +x, face at y = 0.
Mesh hedge(FlyRandom& random, float length_m, float height_m, float texture_contrast);

}  // namespace flies::synth
