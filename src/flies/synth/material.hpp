#pragma once

#include <cstdint>

#include "flies/synth/vec3.hpp"

namespace flies::synth {

/// What varies over a surface. All patterns are evaluated in the object's texture coordinates (metres), so both
/// cameras see the same marks at the same places.
enum class Pattern {
  plain,    ///< faint dirt only
  asphalt,  ///< stones, stains, cracks and patches; horizontal
  slabs,    ///< paving slabs of `scale_m`; horizontal
  plaster,  ///< wall with stains running down
  brick,    ///< courses of bricks with mortar in the colour `second`
  cloth,    ///< folds and weave
  stripes,  ///< cloth with horizontal stripes of `scale_m` in the colour `second`
  checks,   ///< cloth with checks of `scale_m` in the colour `second`
  speckle,  ///< strong irregular light and dark of size `scale_m`: leaves, bark, grass, hair
  worn,     ///< paint on asphalt with holes worn into it
  planks,   ///< boards of `scale_m` along x, their grain running down upright faces
  plate,    ///< number plate: dark signs in the colour `second`
};

struct Material {
  Pattern pattern = Pattern::plain;
  Vec3 colour{0.5F, 0.5F, 0.5F};  ///< reflectance, linear, 0 to 1
  Vec3 second{};
  float contrast = 1.0F;  ///< of the pattern
  float scale_m = 0.1F;   ///< size of the pattern's elements where it has such
  float gloss = 0.0F;     ///< share of the sky mirrored at grazing angles, 0 to 1
  std::uint32_t seed = 0;
};

/// Reflectance at a point of the surface.
/// @param texture     texture coordinates, metres
/// @param footprint_m width of the surface that one ray stands for; finer detail is left out, which keeps far
///                    surfaces from flickering between the two images
Vec3 reflectance(const Material& material, const Vec3& texture, float footprint_m);

}  // namespace flies::synth
