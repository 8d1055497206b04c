#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "flies/synth/path.hpp"
#include "flies/synth/person.hpp"
#include "flies/synth/scene.hpp"
#include "flies/synth/scene_options.hpp"
#include "flies/synth/truth.hpp"

namespace flies {

/// A drive of `kLongest_s` at most through one town street, as a function of time. Our car follows another one, which
/// brakes to a halt; somebody steps onto the road from behind a parked car and crosses before us; a cyclist overtakes
/// us; an oncoming car hides, for a moment, who stands on the other pavement; people walk along the pavements; when
/// the road is free, our car pulls out to the left. Times, speeds and places vary with the seed.
class StreetSequence {
 public:
  static constexpr double kLongest_s = 9.0;

  /// @param options of the street; `people` is how many stand or walk on the pavements, `cars` how many are parked,
  ///                besides those that the story needs. `kind` must be `street`.
  /// @throws InputError when an option is out of range or names another kind of scene
  explicit StreetSequence(const SceneOptions& options);

  /// The scene in the vehicle frame of that time, 0 to `kLongest_s`. Its objects keep their order, so an index into
  /// them is an identity.
  SyntheticScene scene_at(double time_s) const;

  /// Where the vehicle frame is in that of time 0.
  VehiclePose pose_at(double time_s) const;

 private:
  /// A thing that moves. People and riders change their pose as they go.
  struct Mover {
    ObjectClass kind;
    synth::Mesh mesh;        ///< of what keeps its shape
    synth::PersonLook look;  ///< of who walks or rides
    synth::Path path;
  };
  SceneObject object_at(const Mover& mover, float time_s) const;
  void add_vehicles(const SceneOptions& options);
  void add_people(const SceneOptions& options, float crossing_x_m);

  SyntheticScene standing_;  ///< in the world's frame
  synth::Path ego_;
  std::vector<Mover> movers_;
};

}  // namespace flies
