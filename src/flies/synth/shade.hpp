#pragma once

#include <vector>

#include "flies/synth/ray_scene.hpp"

namespace flies::synth {

/// Light of the sky from a direction (a unit vector), for a sky of ambient strength 1.
Vec3 sky_light(const Vec3& direction);

/// Sun with shadows, sky with the part of it that neighbours hide, and a little mirroring.
class Shader {
 public:
  /// @param pixel_angle      width of a pixel at a depth of 1
  /// @param samples_per_side rays a pixel are this squared; each of them looks at its own part of the sky
  Shader(const RayScene& rays, float pixel_angle, int samples_per_side);

  /// Light that comes back along a primary ray whose direction has a depth of 1; `sample` is its number in the pixel.
  Vec3 light_along(const Vec3& origin, const Vec3& direction, int sample) const;

 private:
  float sun_at(const Vec3& point, const Vec3& normal, int sample) const;
  Vec3 sky_at(const Vec3& point, const Vec3& normal, int sample) const;

  const RayScene& rays_;
  float sample_angle_;
  std::vector<Vec3> sky_directions_;  ///< about +z, cosine-distributed; each sample uses kSkyRays of them
  std::vector<Vec3> sun_directions_;  ///< over the disc of the sun, one per sample
};

}  // namespace flies::synth
