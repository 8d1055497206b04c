#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <vector>

#include "flies/synth/scene.hpp"

namespace flies::synth {

/// Where a ray meets the scene. `object` is an index into the scene's objects, -1 for the sky.
struct Hit {
  int object = -1;
  std::uint32_t triangle = 0;
  float distance = 0.0F;  ///< in lengths of the ray's direction
  float u = 0.0F;         ///< barycentric weight of the triangle's second corner
  float v = 0.0F;         ///< and of its third
  Vec3 geometric_normal;  ///< not normalised
};

/// The scene in the form that Embree casts rays at. Refers to the scene, which must outlive it. Casting is const and
/// safe from several threads.
class RayScene {
 public:
  explicit RayScene(const SyntheticScene& scene);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// First thing the ray meets.
  Hit cast(const Vec3& origin, const Vec3& direction) const;
  /// Whether the ray meets anything before `reach` lengths of its direction.
  bool is_blocked(const Vec3& origin, const Vec3& direction, float reach) const;

  const SyntheticScene& scene() const { return scene_; }

 private:
  const SyntheticScene& scene_;
  RTCDevice device_;
  RTCScene rtc_scene_;
};

/// A scene of one object alone, for its silhouette.
class SingleObject {
 public:
  explicit SingleObject(const SceneObject& object);
  bool is_hit(const Vec3& origin, const Vec3& direction) const;

 private:
  SyntheticScene scene_;
  RayScene rays_;
};

/// Rays through the pixels of one camera, in the vehicle frame.
class PixelRays {
 public:
  /// @param is_right the right camera, with the rectification errors of the options
  PixelRays(const StereoCamera& camera, const SceneOptions& options, bool is_right);

  const Vec3& origin() const { return origin_; }
  /// Direction of the pixel (0 at the centre of the first one), scaled to a depth of 1 m along the optical axis.
  Vec3 direction(float u_px, float v_px) const;

 private:
  Vec3 origin_, forward_, right_per_px_, down_per_px_;
  float cx_px_, cy_px_, offset_v_px_ = 0.0F, cos_roll_ = 1.0F, sin_roll_ = 0.0F;
};

}  // namespace flies::synth
