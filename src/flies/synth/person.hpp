#pragma once

#include "flies/core/random.hpp"
#include "flies/synth/geometry.hpp"

namespace flies::synth {

enum class Garment { jacket, shirt, coat, skirt };

/// How a person looks and walks. All sizes follow from the height.
struct PersonLook {
  float height_m = 1.75F;
  float girth = 1.0F;      ///< widths against those of an average adult
  float stride = 1.0F;     ///< 0 stands, 1 walks with usual steps
  float phase_rad = 0.0F;  ///< of the walk; the left leg leads at pi/2
  Garment garment = Garment::jacket;
  Material top, legs, skin, hair, shoes;
  bool long_hair = false;
  bool backpack = false;
  bool hat = false;
  Material bag;
};

/// Draws a look: height, build, clothes, phase. Children (`child`) are 1.0 to 1.45 m tall, adults 1.55 to 1.95 m.
PersonLook random_look(FlyRandom& random, bool child, float texture_contrast);

/// A walking person made of lofted limbs, facing +x, feet on z = 0, the middle of the body above the origin.
Mesh person(const PersonLook& look);

}  // namespace flies::synth
