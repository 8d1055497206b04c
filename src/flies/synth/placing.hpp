#pragma once

#include <vector>

#include "flies/core/random.hpp"
#include "flies/synth/geometry.hpp"
#include "flies/synth/scene.hpp"
#include "flies/synth/taken.hpp"

namespace flies::synth {

/// Where things may stand: a rectangle of the ground, of it what the camera sees.
struct FreeGround {
  float x0_m, x1_m, y0_m, y1_m;
  float half_view = 0.6F;  ///< |y| / x that is still seen
};

/// The share of x to each side that the left camera sees, less `margin` of it.
float half_view_of(const SceneOptions& options, float margin = 0.1F);

/// A thing that looks for its place.
struct Thing {
  ObjectClass kind;
  Mesh mesh;
  float yaw_rad = 0.0F;
  float z_m = 0.0F;
  bool in_sight = true;  ///< only where nothing that stands already hides it
};

/// Puts the thing on a free place of the ground and marks it as taken; false when none was found.
bool find_place(FlyRandom& random, const Thing& thing, const FreeGround& ground, Taken& taken,
                std::vector<SceneObject>& objects);

/// The people of the options, one after the other.
void place_people(const SceneOptions& options, const FreeGround& ground, Taken& taken,
                  std::vector<SceneObject>& objects);

}  // namespace flies::synth
