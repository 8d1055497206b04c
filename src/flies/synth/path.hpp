#pragma once

#include <vector>

#include "flies/synth/geometry.hpp"

namespace flies::synth {

/// Speed along a path at a time; between two of them it changes evenly, before the first and after the last it stays.
struct SpeedAt {
  float time_s, speed_mps;
};

/// A smooth step to the side of a path, positive to the left.
struct SideStep {
  float begin_s = 0.0F, end_s = 1.0F;
  float shift_m = 0.0F;
};

/// How a thing moves over ground: along a straight line, but for one step to the side.
struct Path {
  Placement start;  ///< at time 0; its yaw is the direction of the line
  std::vector<SpeedAt> speeds;
  SideStep side_step = {};

  /// Distance along the line since time 0.
  float travelled_m(float time_s) const;
  /// Where the thing stands at a time >= 0; it faces the way it goes.
  Placement at(float time_s) const;
  /// Velocity over ground, world axes; z is 0.
  Vec3 velocity_at(float time_s) const;

 private:
  float speed_mps(float time_s) const;
};

/// The placement of the origin of the world as seen from something that stands at `placement`.
Placement inverse(const Placement& placement);

}  // namespace flies::synth
