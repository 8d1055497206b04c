#include "flies/synth/shade.hpp"

#include <numbers>

#include "flies/synth/noise.hpp"

namespace flies::synth {
namespace {

constexpr int kSkyRays = 2;             ///< per sample
constexpr float kGroundBounce = 0.35F;  ///< light from below against that of the open sky
constexpr float kHiddenBounce = 0.22F;  ///< light from a neighbour that hides the sky
constexpr float kSunRadius_rad = 0.008F;
constexpr float kGoldenAngle_rad = 2.39996323F;

/// Turns a direction about +z into one about `normal`.
Vec3 about(const Vec3& normal, const Vec3& d) {
  const Vec3 helper = std::abs(normal.z) < 0.9F ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 tangent = normalized(cross(helper, normal));
  return tangent * d.x + cross(normal, tangent) * d.y + normal * d.z;
}

}  // namespace

Vec3 sky_light(const Vec3& direction) {
  const float up = std::clamp(direction.z, 0.0F, 1.0F);
  const Vec3 clear = mix(Vec3{1.05F, 1.12F, 1.2F}, Vec3{0.45F, 0.68F, 1.05F}, std::sqrt(up));
  const Vec3 on_dome = direction * (1.0F / (up + 0.15F));
  const float cloud = fractal_noise({on_dome.x, on_dome.y, 0}, 1.3F, 0.1F, 0.55F, 0.01F, 77);
  return mix(clear, Vec3{1.25F, 1.25F, 1.25F}, std::clamp(0.9F * cloud + 0.2F, 0.0F, 0.9F));
}

Shader::Shader(const RayScene& rays, float pixel_angle, int samples_per_side)
    : rays_(rays), sample_angle_(pixel_angle / static_cast<float>(samples_per_side)) {
  const int samples = samples_per_side * samples_per_side;
  const int count = samples * kSkyRays;
  sky_directions_.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const float area = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
    const float radius = std::sqrt(area), angle = kGoldenAngle_rad * static_cast<float>(i);
    // Sample s takes the directions s and s + samples: one from the inner and one from the outer half of the sky.
    sky_directions_[static_cast<std::size_t>((i % samples) * kSkyRays + i / samples)] = {
        radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1.0F - area)};
  }
  for (int i = 0; i < samples; ++i) {
    const float radius = kSunRadius_rad * std::sqrt((static_cast<float>(i) + 0.5F) / static_cast<float>(samples));
    const float angle = kGoldenAngle_rad * static_cast<float>(i);
    sun_directions_.push_back(
        about(rays.scene().lighting.to_sun, {radius * std::cos(angle), radius * std::sin(angle), 1.0F}));
  }
}

float Shader::sun_at(const Vec3& point, const Vec3& normal, int sample) const {
  const Lighting& lighting = rays_.scene().lighting;
  const float facing = dot(normal, lighting.to_sun);
  if (lighting.sun <= 0.0F || facing <= 0.0F) return 0.0F;
  constexpr float kReach_m = 200.0F;
  const Vec3& direction = sun_directions_[static_cast<std::size_t>(sample)];
  return rays_.is_blocked(point, direction, kReach_m) ? 0.0F : lighting.sun * facing;
}

Vec3 Shader::sky_at(const Vec3& point, const Vec3& normal, int sample) const {
  Vec3 sum;
  for (int k = 0; k < kSkyRays; ++k) {
    const Vec3 direction = about(normal, sky_directions_[static_cast<std::size_t>(sample * kSkyRays + k)]);
    if (rays_.is_blocked(point, direction, rays_.scene().lighting.sky_reach_m)) {
      sum = sum + Vec3{1, 1, 1} * kHiddenBounce;
    } else {
      // Below the horizon comes what the ground gives back. The passage is soft, or round things would show an edge.
      const float above = std::clamp(0.5F + 2.5F * direction.z, 0.0F, 1.0F);
      sum = sum + mix(Vec3{1.0F, 0.97F, 0.93F} * kGroundBounce, Vec3{0.94F, 1.0F, 1.08F}, above);
    }
  }
  return sum * (rays_.scene().lighting.ambient / kSkyRays);
}

Vec3 Shader::light_along(const Vec3& origin, const Vec3& direction, int sample) const {
  const Hit hit = rays_.cast(origin, direction);
  const Lighting& lighting = rays_.scene().lighting;
  if (hit.object < 0) return sky_light(normalized(direction)) * (lighting.ambient + 0.45F * lighting.sun);

  const Mesh& mesh = rays_.scene().objects[static_cast<std::size_t>(hit.object)].mesh;
  const auto& t = mesh.triangles[hit.triangle];
  const auto blend = [&](const std::vector<Vec3>& values) {
    return values[t.a] * (1.0F - hit.u - hit.v) + values[t.b] * hit.u + values[t.c] * hit.v;
  };
  const Vec3 view = normalized(direction);
  Vec3 flat_normal = normalized(hit.geometric_normal);
  if (dot(flat_normal, view) > 0.0F) flat_normal = flat_normal * -1.0F;
  Vec3 normal = normalized(blend(mesh.normals));
  if (dot(normal, flat_normal) < 0.0F) normal = normal * -1.0F;

  const float depth_m = hit.distance;
  const float slant = std::max(0.05F, -dot(flat_normal, view));
  const float footprint_m = depth_m * sample_angle_ / std::sqrt(slant);
  const Vec3 colour = reflectance(mesh.materials[t.material], blend(mesh.texture), footprint_m);

  // Shadow rays start a little off the surface, farther away where floats are coarser.
  const Vec3 point = origin + direction * depth_m + flat_normal * (1e-3F + 1e-4F * depth_m);
  const Vec3 sun_colour{1.0F, 0.96F, 0.88F};
  Vec3 light = colour * (sun_colour * sun_at(point, normal, sample) + sky_at(point, normal, sample));

  const float gloss = mesh.materials[t.material].gloss;
  if (gloss > 0.0F) {
    const float grazing = 1.0F - std::max(0.0F, -dot(normal, view));
    const float mirrored = gloss * (0.08F + 0.92F * std::pow(grazing, 5.0F));
    const Vec3 reflected = view - normal * (2.0F * dot(normal, view));
    const Vec3 seen = reflected.z > 0.0F ? sky_light(reflected) : Vec3{0.12F, 0.12F, 0.12F};
    light = mix(light, seen * (lighting.ambient + 0.3F * lighting.sun), mirrored);
  }
  return light;
}

}  // namespace flies::synth
