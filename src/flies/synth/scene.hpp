#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "flies/synth/geometry.hpp"
#include "flies/synth/scene_options.hpp"

namespace flies {

/// What a synthetic object is. Ground and backdrop are scenery: they are seen but are no obstacles.
enum class ObjectClass {
  ground,
  backdrop,
  wall,
  hedge,
  car,
  pole,
  tree,
  pedestrian,
  cyclist,
  box,
  furniture,
  pallet,
  shelf,
  kerb
};
inline constexpr std::array<std::string_view, 14> kObjectClassNames = {
    "ground",     "backdrop", "wall", "hedge",     "car",    "pole",  "tree",
    "pedestrian", "cyclist",  "box",  "furniture", "pallet", "shelf", "kerb"};
constexpr bool is_obstacle(ObjectClass kind) { return kind != ObjectClass::ground && kind != ObjectClass::backdrop; }

/// One object in its place. The footprint is the rectangle of its body on the ground.
struct SceneObject {
  ObjectClass kind = ObjectClass::ground;
  synth::Mesh mesh;  ///< in the vehicle frame
  double x_m = 0.0;  ///< centre of the footprint, vehicle frame
  double y_m = 0.0;
  double z_m = 0.0;      ///< its lowest point
  double yaw_rad = 0.0;  ///< direction of its length, positive to the left; people face this way
  double length_m = 0.0;
  double width_m = 0.0;
  double height_m = 0.0;
  double vx_mps = 0.0;  ///< over ground, vehicle frame
  double vy_mps = 0.0;
};

struct Lighting {
  synth::Vec3 to_sun{0, 0, 1};  ///< unit vector
  float sun = 1.0F;             ///< light on a surface square to the sun
  float ambient = 0.5F;         ///< light of the whole sky on the ground
  float sky_reach_m = 4.0F;     ///< what is farther away than this hides no sky; little under a ceiling full of lamps
};

/// Sun and sky of the options.
Lighting lighting_of(const SceneOptions& options);

struct SyntheticScene {
  std::vector<SceneObject> objects;
  Lighting lighting;
};

/// Lays out the scene that the options describe, in the vehicle frame.
/// @throws InputError when an option is out of range
SyntheticScene build_scene(const SceneOptions& options);

}  // namespace flies
